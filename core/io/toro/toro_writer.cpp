#include <quiver/core/io/toro/toro_writer.h>

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include <quiver/core/io/toro/bearing_range.h>
#include <quiver/core/util/error.h>

namespace quiver::detail {
namespace {

constexpr std::string_view planarEdge = "EDGE_SE2", landmarkEdge = "EDGE_SE2_XY";

template <typename Tags>
bool contains(const Tags& tags, std::string_view tag) {
  return std::find(tags.begin(), tags.end(), tag) != tags.end();
}

[[noreturn]] void refuse(std::string_view tag) {
  const bool quaternion = tag == "VERTEX_SE3:QUAT" || tag == "EDGE_SE3:QUAT";
  throw GraphError(fmt::format("TORO files have no {}{}", tag,
                               quaternion ? "; withEulerAngles() makes VERTEX3 and "
                                            "EDGE3 of such a graph"
                                          : ""));
}

}  // namespace

std::string_view toroTag(std::string_view tag) {
  if (tag == "VERTEX_SE2") return "VERTEX2";
  if (tag == planarEdge) return "EDGE2";
  if (tag == landmarkEdge) return "BR";
  return tag;
}

void checkToro(const Graph& graph) {
  constexpr std::array<std::string_view, 3> vertices{"VERTEX_SE2", "VERTEX_XY", "VERTEX3"};
  constexpr std::array<std::string_view, 3> edges{planarEdge, landmarkEdge, "EDGE3"};
  graph.forEachParameter([&](const Parameter& parameter) { refuse(graph.typeOf(parameter).tag()); });
  graph.forEachVertex([&](const Vertex& vertex) {
    if (!contains(vertices, graph.typeOf(vertex).tag())) refuse(graph.typeOf(vertex).tag());
  });
  graph.forEachEdge([&](const Edge& edge) {
    const EdgeType& type = graph.typeOf(edge);
    if (!contains(edges, type.tag())) refuse(type.tag());
    if (type.tag() == landmarkEdge && !bearingRangeOf(type, edge)) {
      throw GraphError(
          fmt::format("TORO's BR cannot hold {} {} {}: its information is not that of a bearing and a "
                      "range",
                      type.tag(), edge.vertexId(0), edge.vertexId(1)));
    }
  });
}

void writeToroEdge(const EdgeType& type, const Edge& edge, FieldWriter& writer) {
  if (type.tag() == landmarkEdge) {
    const std::optional<BearingRange> line = bearingRangeOf(type, edge);
    if (!line) throw GraphError(fmt::format("TORO's BR cannot hold this {}", type.tag()));
    return writer.reals(std::array{line->bearing, line->range, line->bearingDeviation, line->rangeDeviation});
  }
  type.write(edge, writer);
  if (!type.hasInformationField()) return;
  const std::span<const double> I = type.information(edge);
  if (type.tag() == planarEdge) return writer.reals(std::array{I[0], I[1], I[3], I[5], I[2], I[4]});
  writer.reals(I);
}

}  // namespace quiver::detail
