#include <quiver/initialization/spanning_tree.h>

#include <algorithm>
#include <cstdlib>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <quiver/core/graph/estimates.h>
#include <quiver/initialization/estimate_tree.h>

namespace quiver {
namespace {

/// An eigenvalue of Ω counts as at least this share of the largest one, …
constexpr double leastShare = 1e-12;
/// … and an edge that says nothing at all is this long.
constexpr double unknownLength = 1e30;

/// trace(Ω⁻¹) of a matrix that has no inverse, with its least eigenvalues raised.
double singularTrace(const Eigen::MatrixXd& information) {
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(information, Eigen::EigenvaluesOnly).eigenvalues();
  const double largest = values.maxCoeff();
  if (!(largest > 1.0 / unknownLength)) return unknownLength;
  return std::min(unknownLength, values.cwiseMax(leastShare * largest).cwiseInverse().sum());
}

/// trace(Ω⁻¹) = ‖L⁻¹‖² with Ω = L Lᵀ.
double accumulatedVariance(const EdgeType& type, const Edge& edge) {
  const int n = type.errorDimension(edge);
  const std::span<const double> triangle = type.information(edge);
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 8, 8>;
  const auto fill = [&](auto&& matrix) {
    std::size_t k = 0;
    for (int r = 0; r < n; ++r) {
      for (int c = r; c < n; ++c) matrix(r, c) = matrix(c, r) = triangle[k++];
    }
  };
  const auto trace = [&](auto&& information) {
    using Square = std::remove_cvref_t<decltype(information)>;
    fill(information);
    const Eigen::LLT<Square> factor(information);
    const auto diagonal = factor.matrixLLT().diagonal();
    const double least = diagonal.minCoeff();
    if (factor.info() != Eigen::Success || !(least * least > leastShare * information.diagonal().maxCoeff()))
      return singularTrace(information);
    const Square inverse = factor.matrixL().solve(Square::Identity(n, n));
    return std::min(unknownLength, inverse.squaredNorm());
  };
  return n <= 8 ? trace(Small(n, n)) : trace(Eigen::MatrixXd(n, n));
}

/// Nothing between vertices of consecutive ids, one for every other edge.
double jumps(const EdgeType&, const Edge& edge) {
  return edge.arity() == 2 && std::abs(edge.vertexId(0) - edge.vertexId(1)) == 1 ? 0.0 : 1.0;
}

std::string estimateByTree(Graph& graph, const Options& options, detail::EstimateTree::Length length,
                           const std::string& name) {
  EstimatesGuard guard(graph);
  detail::EstimateTree tree(graph, options, length);
  tree.grow();
  guard.keep();
  return tree.describe(name);
}

}  // namespace

std::string spanningTreeEstimate(Graph& graph, const Options& options) {
  return estimateByTree(graph, options, accumulatedVariance, "a tree of least accumulated variance");
}

std::string odometryEstimate(Graph& graph, const Options& options) {
  return estimateByTree(graph, options, jumps, "the odometry");
}

}  // namespace quiver
