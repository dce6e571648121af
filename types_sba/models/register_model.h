#pragma once

#include <string>

#include <quiver/core/registry/registry.h>
#include <quiver/types_sba/models/edge_project.h>

namespace quiver::detail {

/// Makes one camera model known: PARAMS_NAME, VERTEX_NAME, EDGE_PROJECT_NAME and EDGE_PROJECT_NAME:INTRINSICS.
template <typename Parameter, typename Vertex, typename Edge, typename EdgeIntrinsics>
void registerModel(Registry& registry, const std::string& name, const std::string& description) {
  registry.addParameter<Parameter>("PARAMS_" + name, "Intrinsics of " + description);
  registry.addVertex<Vertex>("VERTEX_" + name, "Intrinsics, estimated and shared by any number of cameras, of " +
                                                   description + " Step: addition.");
  registry.addEdge<Edge>("EDGE_PROJECT_" + name,
                         "Pixel of a point. Error pi(X^-1 l) - z by the parameter's camera; information (u, v).");
  registry.addEdge<EdgeIntrinsics>("EDGE_PROJECT_" + name + ":INTRINSICS",
                                   "Pixel of a point. Error pi(X^-1 l) - z by the camera of the third vertex; "
                                   "information (u, v).");
}

}  // namespace quiver::detail
