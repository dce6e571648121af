#include <quiver/apps/optimize/marginals_file.h>

#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <quiver/core/io/text/number_writer.h>

namespace quiver::app {

std::string describeMarginals(const Marginals& marginals, const Graph& graph) {
  NumberWriter lines;
  std::set<std::string> comments;
  for (const std::int64_t id : marginals.vertices()) {
    const Vertex& vertex = *graph.findVertex(id);
    const VertexType& type = graph.typeOf(vertex);
    const Eigen::MatrixXd covariance = marginals.covariance(id);
    comments.insert(
        fmt::format("# {}: {}\n", type.tag(), fmt::join(type.tangentNames(static_cast<int>(covariance.rows())), ", ")));
    lines.text(type.tag());
    lines.character(' ');
    lines.integer(id);
    for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
      for (Eigen::Index column = row; column < covariance.cols(); ++column) {
        lines.character(' ');
        lines.real(covariance(row, column));
      }
    }
    lines.character('\n');
  }
  for (const std::int64_t id : marginals.undetermined())
    comments.insert(fmt::format("# vertex {} is not constrained in every direction: it has no covariance\n", id));
  constexpr double coarse = 1e-3;
  if (marginals.relativeError() > coarse) {
    comments.insert(fmt::format(
        "# The system is nearly singular: variances of what is known least may be off by {:.0e} of themselves.\n",
        marginals.relativeError()));
  }
  return fmt::format(
      "# Covariances of the estimates: tag, id, upper triangle row by row in the directions of the tangent.\n"
      "# Gauge: {}; what was held has zeros.\n{}{}",
      marginals.gauge().reason.empty() ? "nothing was to be held" : marginals.gauge().reason, fmt::join(comments, ""),
      lines.view());
}

}  // namespace quiver::app
