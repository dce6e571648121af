// An edge type with Jacobians of its own: the bearing of a landmark seen from a robot, eight edges at a time.
#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/quiver.h>
#include <iostream>
using namespace quiver;

class EdgeBearing : public BaseEdge<EdgeBearing, 1, double, VertexSE2, VertexXY> {
 public:
  static constexpr bool lanes = true;

  /// The angle between the measured direction and the landmark's, from −π to π.
  template <typename S>
  static Vector<S, 1> computeError(const S& bearing, const SE2<S>& robot, const Vector<S, 2>& landmark) {
    using std::atan2;
    const Vector<S, 2> p = SO2<S>(bearing).inverse() * robot.actInverse(landmark);
    return Vector<S, 1>(atan2(p[1], p[0]));
  }

  /// With p the landmark in the robot's frame: ∂ atan2 = (−p_y, p_x) / |p|² ∂p, and ∂p = (−I, (p_y, −p_x)) for the
  /// robot, Rᵀ for the landmark.
  template <typename S>
  static void linearizeOplus(const S& /*bearing*/, const SE2<S>& robot, const Vector<S, 2>& landmark,
                             Matrix<S, 1, 3>& J0, Matrix<S, 1, 2>& J1) {
    const Vector<S, 2> p = robot.actInverse(landmark);
    const S square = p[0] * p[0] + p[1] * p[1];
    const S u = -p[1] / square;
    const S v = p[0] / square;
    J0(0, 0) = -u, J0(0, 1) = -v, J0(0, 2) = S(-1.0);
    const S c = robot.rotation().cosine();
    const S s = robot.rotation().sine();
    J1(0, 0) = c * u - s * v, J1(0, 1) = s * u + c * v;
  }
};

int main() {
  auto registry = builtinRegistry();
  registry->addEdge<EdgeBearing>("EDGE_BEARING");
  Graph graph(registry);
  const Vector<double, 2> tower(4.0, 7.0);
  graph.addVertex<VertexXY>(100, Vector<double, 2>(2.0, 2.0));
  for (std::int64_t id = 0; id < 4; ++id) {
    const SE2<double> robot(static_cast<double>(id), 0.5 * static_cast<double>(id % 2), 0.3 * static_cast<double>(id));
    graph.addVertex<VertexSE2>(id, robot).setFixed(true);
    const Vector<double, 2> seen = robot.actInverse(tower);
    graph.addEdge<EdgeBearing>({id, 100}, std::atan2(seen[1], seen[0]), Matrix<double, 1, 1>(1e4));
  }
  std::cout << checkJacobians(graph).describe() << "\n";
  const Summary summary = optimize(graph);
  std::cout << summary << "the tower stands at " << graph.vertex<VertexXY>(100).estimate().transpose() << "\n";
  return summary.converged() ? 0 : 1;
}
