#include "core_types.h"

#include <quiver/plugins/builtin.h>

namespace quiver::test {

std::shared_ptr<Registry> makeRegistry() {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<VertexSE2>("VERTEX_SE2");
  registry->addVertex<VertexPoint>("VERTEX_POINT");
  registry->addVertex<VertexNumbers>("VERTEX_NUMBERS");
  registry->addParameter<ParameterShift>("PARAMETER_SHIFT");
  registry->addEdge<EdgeSE2>("EDGE_SE2");
  registry->addEdge<EdgeRangeNumeric>("EDGE_RANGE_NUMERIC");
  registry->addEdge<EdgeRangeDual>("EDGE_RANGE_DUAL");
  registry->addEdge<EdgeRangeDualLanes>("EDGE_RANGE_DUAL_LANES");
  registry->addEdge<EdgeRangeAnalytic>("EDGE_RANGE_ANALYTIC");
  registry->addEdge<EdgeRangeAnalyticLanes>("EDGE_RANGE_ANALYTIC_LANES");
  registry->addEdge<EdgePoint>("EDGE_POINT");
  registry->addEdge<EdgeWrong>("EDGE_WRONG");
  registry->addEdge<EdgeShifted>("EDGE_SHIFTED");
  registry->addEdge<EdgeMean>("EDGE_MEAN");
  registry->addEdge<EdgeSquares>("EDGE_SQUARES");
  registerLinearSystems(*registry);
  return registry;
}

}  // namespace quiver::test
