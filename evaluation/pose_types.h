#pragma once

#include <vector>

#include <quiver/core/registry/registry.h>
#include <quiver/geometry/se3.h>

namespace quiver {

/// Turns a vertex's values into its pose, body to world: of a camera, the translation is its centre.
using PoseOfValues = SE3<double> (*)(const double* values);

/// The vertex types that are poses, and how their values say so. Poses in the plane lie at z = 0.
class PoseTypes {
 public:
  /// Those of the registry, as it is now, whose estimate is an SE2 or SE3.
  explicit PoseTypes(const Registry& registry);

  /// A type of the same registry whose vertices are poses in space.
  void add(const VertexType& type, PoseOfValues pose);

  /// None for types that are no poses.
  PoseKind kind(const VertexType& type) const;
  /// Requires a kind that is not none, and a vertex with an estimate.
  SE3<double> pose(const VertexType& type, const Vertex& vertex) const;

 private:
  struct Entry {
    PoseKind kind = PoseKind::none;
    PoseOfValues pose = nullptr;
  };
  /// By the index of the type in the registry.
  std::vector<Entry> entries_;
};

}  // namespace quiver
