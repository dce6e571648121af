#include <tests/io/graph_types.h>

#include <quiver/core/graph/robust_kernels.h>

namespace quiver::test {
namespace {

RobustValue plainKernel(double e, double, double) { return {e, 1.0, 0.0}; }
constexpr RobustKernelType shapedKernel{"Shaped", plainKernel, "for tests", true, 2.0};

}  // namespace

std::shared_ptr<Registry> makeRegistry() {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<Pose2>("VERTEX_SE2");
  registry->addVertex<Point2>("VERTEX_XY");
  registry->addVertex<Pose3>("VERTEX_SE3:QUAT");
  registry->addParameter<Offset2>("PARAMS_SE2OFFSET");
  registry->addParameter<Scale>("PARAMS_SCALE");
  registry->addEdge<Odometry2>("EDGE_SE2");
  registry->addEdge<Sighting2>("EDGE_SE2_XY");
  registry->addEdge<OffsetSighting2>("EDGE_SE2_POINTXY_OFFSET");
  registry->addEdge<Prior2>("EDGE_PRIOR_XY");
  registry->addEdge<Odometry3>("EDGE_SE3:QUAT");
  registry->addEdge<Panorama2>("EDGE_SE2_LOTSOFXY");
  registry->addAlias("VERTEX_POINT", "VERTEX_XY");
  registry->addDataTag("ROBOTLASER1");
  registry->addRobustKernel(huberKernel());
  registry->addRobustKernel(shapedKernel);
  return registry;
}

}  // namespace quiver::test
