// A program of somebody else: types of its own, a graph of its own, solved by the installed library. Its flags differ
// from the library's; four doubles side by side are where Eigen's alignment would differ with them.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/registry/registry.h>
#include <quiver/smoothing/marginals.h>
#include <quiver/solvers/normal_equations.h>
#include <quiver/version.h>

using namespace quiver;

class VertexState : public BaseVertex<VertexState, 4, Vector<double, 4>> {
 public:
  template <typename S>
  static Vector<S, 4> oplus(const Vector<S, 4>& x, const Vector<S, 4>& delta) {
    return x + delta;
  }
};

class EdgeDifference : public BaseEdge<EdgeDifference, 4, Vector<double, 4>, VertexState, VertexState> {
 public:
  static constexpr bool lanes = true;
  template <typename S>
  static Vector<S, 4> computeError(const Vector<S, 4>& measured, const Vector<S, 4>& from, const Vector<S, 4>& to) {
    return to - from - measured;
  }
};

class EdgeRadius : public BaseEdge<EdgeRadius, 1, double, VertexState> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const S& radius, const Vector<S, 4>& state) {
    return Vector<S, 1>(state.squaredNorm() - radius * radius);
  }
};

int main() {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<VertexState>("VERTEX_STATE");
  registry->addEdge<EdgeDifference>("EDGE_DIFFERENCE");
  registry->addEdge<EdgeRadius>("EDGE_RADIUS");
  registry->addLinearSystem("auto", "the normal equations", [](const Options&) -> std::unique_ptr<LinearSystem> {
    return std::make_unique<NormalEquations>();
  });

  // A chain along (1, 2, 3, 4)/10 from a known start, each state with its distance from the origin.
  constexpr int count = 100;
  const Vector<double, 4> stride(0.1, 0.2, 0.3, 0.4);
  Graph graph(registry);
  for (int i = 0; i < count; ++i) {
    graph.addVertex<VertexState>(i, Vector<double, 4>::Constant(0.25 * i) + Vector<double, 4>(1, 0, 0, 0.5));
    graph.addEdge<EdgeRadius>({i}, (stride * (i + 1)).norm(), Matrix<double, 1, 1>::Identity());
    if (i > 0) graph.addEdge<EdgeDifference>({i - 1, i}, stride, 100.0 * Matrix<double, 4, 4>::Identity());
  }
  graph.vertex<VertexState>(0).setEstimate(stride);
  graph.vertex<VertexState>(0).setFixed(true);
  const Summary summary = optimize(graph);

  // Matrices of run-time size are made here, whatever the library's flags are.
  const Marginals marginals(graph);
  const double last = marginals.covariance(count - 1).trace();
  const double both = marginals.joint(std::vector<std::int64_t>{1, count - 1}).bottomRightCorner(4, 4).trace();

  const double difference = (graph.vertex<VertexState>(count - 1).estimate() - stride * count).norm();
  std::printf("quiver %s: %s\nfinal chi2 %.3g, off by %.3g\n", QUIVER_VERSION, summary.reason.c_str(),
              summary.finalChi2, difference);
  const bool known = last > 0.0 && std::abs(both - last) <= 1e-9 * last;
  return summary.status == Status::converged && summary.finalChi2 < 1e-9 && difference < 1e-6 && known ? 0 : 1;
}
