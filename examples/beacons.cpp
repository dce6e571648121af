// A map of radio beacons from a robot's odometry and the ranges it measured: reads plaza.g2o, which simulate_plaza
// writes.
#include <quiver/quiver.h>
#include <iostream>
using namespace quiver;

class VertexBeacon : public BaseVertex<VertexBeacon, 2, Vector<double, 2>> {
 public:
  template <typename S>  // S is double, 8 lanes, or a dual number over either
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return x + delta;
  }
  static constexpr std::array tangent{"x [m]", "y [m]"};  // the diagnosis speaks in these names
};

class EdgeRange : public BaseEdge<EdgeRange, 1, double, VertexSE2, VertexBeacon> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const S& range, const SE2<S>& robot, const Vector<S, 2>& beacon) {
    return Vector<S, 1>((beacon - robot.translation()).norm() - range);
  }
};

int main() {
  auto registry = builtinRegistry();  // an ordinary object: no static initialisers anywhere
  registry->addVertex<VertexBeacon>("VERTEX_BEACON");
  registry->addEdge<EdgeRange>("EDGE_RANGE_SE2_XY");  // reading and writing measurement + information come along
  Graph graph = readGraph("plaza.g2o", registry);  // throws ParseError: plaza.g2o:17:1: unknown tag …, did you mean …
  Summary summary = optimize(graph, {.maxIterations = 30});
  std::cout << summary;  // status, reason, table; never an unexplained number
  writeGraph("out.g2o", graph);
}
