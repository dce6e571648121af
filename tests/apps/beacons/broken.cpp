// A plugin for the tests: what `quiver check` must find.
#include <stdexcept>

#include <quiver/quiver.h>

namespace {

using namespace quiver;

/// The x of a pose in the plane, with a Jacobian that forgets that steps are in the body's frame.
class EdgeAbscissa : public BaseEdge<EdgeAbscissa, 1, double, VertexSE2> {
 public:
  static Vector<double, 1> computeError(const double& x, const SE2<double>& robot) {
    return Vector<double, 1>(robot.x() - x);
  }
  static void linearizeOplus(const double&, const SE2<double>&, Matrix<double, 1, 3>& J) { J << 1.0, 0.0, 0.0; }
};

/// Throws.
class EdgeThrowing : public BaseEdge<EdgeThrowing, 1, double, VertexSE2> {
 public:
  static Vector<double, 1> computeError(const double& x, const SE2<double>&) {
    if (x > 0.0) throw std::runtime_error("no error today");
    throw 1;
  }
};

/// A kernel whose weight is not its slope.
const RobustKernelType lopsided{"Lopsided",
                                [](double e, double, double) {
                                  return RobustValue{e, 1.0 / (1.0 + e), 0.0};
                                },
                                "a mistake"};

void registerBroken(Registry& registry) {
  registry.addEdge<EdgeAbscissa>("EDGE_ABSCISSA");
  registry.addEdge<EdgeThrowing>("EDGE_THROWING");
  registry.addRobustKernel(lopsided);
}

}  // namespace

QUIVER_PLUGIN(registerBroken);
