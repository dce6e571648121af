// A Jacobian's structural zeros need not be written.
#include <limits>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/quiver.h>

#include "core_types.h"

namespace quiver {
namespace {

/// z − (b − a) of two points in the plane; Jacobians write their diagonals alone.
template <bool inLanes>
class EdgeSparse : public BaseEdge<EdgeSparse<inLanes>, 2, Vector<double, 2>, test::VertexPoint, test::VertexPoint> {
 public:
  static constexpr bool lanes = inLanes;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 2>& a, const Vector<S, 2>& b) {
    return Vector<S, 2>(b - a - z);
  }
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, 2>&, const Vector<S, 2>&, Matrix<S, 2, 2>& A,
                             Matrix<S, 2, 2>& B) {
    A(0, 0) = A(1, 1) = S(-1.0);
    B(0, 0) = B(1, 1) = S(1.0);
  }
};

/// Leaves a stack that is not a number.
__attribute__((noinline)) double soilStack() {
  volatile double numbers[20000];
  for (volatile double& number : numbers) number = std::numeric_limits<double>::quiet_NaN();
  return numbers[7];
}

template <typename Edge>
void expectOneStep(const std::string& algorithm) {
  auto registry = test::makeRegistry();
  registry->addEdge<Edge>("EDGE_SPARSE");
  Graph graph(registry);
  for (int i = 0; i < 20; ++i) graph.addVertex<test::VertexPoint>(i, Vector<double, 2>(0.3 * i, -0.1 * i * i));
  graph.findVertex(0)->setFixed(true);
  for (int i = 0; i + 1 < 20; ++i)
    graph.addEdge<Edge>({i, i + 1}, Vector<double, 2>(1.0, 0.5), Matrix<double, 2, 2>::Identity());
  EXPECT_TRUE(std::isnan(soilStack()));
  const Summary summary = optimize(graph, {.algorithm = algorithm});
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  EXPECT_LT(summary.finalChi2, 1e-20);
  EXPECT_LE(summary.iterations.size(), 2U);
}

TEST(UnwrittenJacobian, EntriesAreZero) {
  expectOneStep<EdgeSparse<false>>("gn");
  expectOneStep<EdgeSparse<true>>("gn");
}

}  // namespace
}  // namespace quiver
