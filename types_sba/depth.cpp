#include <quiver/types_sba/depth.h>

#include <unordered_map>

#include <quiver/types_sba/edge_project_bal.h>
#include <quiver/types_sba/edge_project_cam.h>
#include <quiver/types_sba/edge_project_inverse_depth.h>
#include <quiver/types_sba/expmap/edge_project_xyz2uv.h>
#include <quiver/types_sba/expmap/edge_se3_project_xyz.h>
#include <quiver/types_sba/models/edge_project.h>
#include <quiver/types_sba/sim3/edge_sim3.h>

namespace quiver {
namespace {

using Test = bool (*)(const Graph&, const Edge&);

/// By the index of an edge type in a registry.
using Tests = std::unordered_map<int, Test>;

template <typename... E>
Tests testsOf(const Registry& registry) {
  Tests tests;
  const auto add = [&](std::string_view name, Test test) {
    if (const EdgeType* type = registry.findEdgeTypeByName(name)) tests.emplace(type->index(), test);
  };
  (add(typeName<E>(),
       [](const Graph& graph, const Edge& edge) { return isDepthPositive(graph, static_cast<const E&>(edge)); }),
   ...);
  return tests;
}

}  // namespace

DepthSurvey surveyDepth(const Graph& graph) {
  const Tests tests =
      testsOf<EdgeProjectBal, EdgeProjectP2MC, EdgeProjectP2SC, EdgeProjectP2MCIntrinsics, EdgeProjectXYZ2UV,
              EdgeProjectXYZ2UVU, EdgeSE3ProjectXYZ, EdgeStereoSE3ProjectXYZ, EdgeSE3ProjectXYZOnlyPose,
              EdgeStereoSE3ProjectXYZOnlyPose, EdgeProjectPSI2UV, EdgeProjectInverseDepth,
              EdgeProjectInverseDepthAnchor, EdgeProjectSim3, EdgeProjectInverseSim3, EdgeProjectPinhole,
              EdgeProjectBrown, EdgeProjectFisheye, EdgeProjectSnavely, EdgeProjectPinholeIntrinsics,
              EdgeProjectBrownIntrinsics, EdgeProjectFisheyeIntrinsics, EdgeProjectSnavelyIntrinsics>(
          *graph.registry());
  DepthSurvey survey;
  graph.forEachEdge([&](const Edge& edge) {
    const auto test = tests.find(edge.type());
    if (test == tests.end()) return;
    for (const std::int64_t id : edge.vertexIds()) {
      if (!graph.findVertex(id)->hasEstimate()) return;
    }
    ++survey.observations;
    if (test->second(graph, edge)) return;
    if (survey.behind++ == 0) survey.first = &edge;
  });
  return survey;
}

}  // namespace quiver
