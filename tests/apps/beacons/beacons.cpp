// A plugin for the tests: beacons whose range a robot in the plane measures.
#include <array>
#include <new>

#include <quiver/quiver.h>

namespace {

using namespace quiver;

class VertexBeacon : public BaseVertex<VertexBeacon, 2, Vector<double, 2>> {
 public:
  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return x + delta;
  }
  static constexpr std::array tangent{"x [m]", "y [m]"};
  static Vector<double, 2> place(const Vector<double, 2>& x) { return x; }
};

class EdgeRange : public BaseEdge<EdgeRange, 1, double, VertexSE2, VertexBeacon> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const S& range, const SE2<S>& robot, const Vector<S, 2>& beacon) {
    return Vector<S, 1>((beacon - robot.translation()).norm() - range);
  }
};

void registerBeacons(Registry& registry) {
  registry.addVertex<VertexBeacon>("VERTEX_BEACON");
  registry.addEdge<EdgeRange>("EDGE_RANGE_SE2_XY");
  registry.addInitializer("exhausting", "Asks for more memory than there is.",
                          [](Graph&, const Options&) -> std::string { throw std::bad_alloc(); });
}

}  // namespace

QUIVER_PLUGIN(registerBeacons);
