#include <quiver/evaluation/pose_types.h>

#include <cmath>

#include <quiver/geometry/packing.h>

namespace quiver {
namespace {

SE3<double> planarPose(const double* values) {
  const double half = 0.5 * values[2];
  return SE3<double>(values[0], values[1], 0.0, 0.0, 0.0, std::sin(half), std::cos(half));
}

SE3<double> spatialPose(const double* values) { return Packing<SE3<double>>::load(values); }

}  // namespace

PoseTypes::PoseTypes(const Registry& registry) {
  for (const auto& type : registry.vertexTypes()) {
    const PoseKind kind = type->poseKind();
    entries_.push_back({kind, kind == PoseKind::plane ? planarPose : spatialPose});
  }
}

void PoseTypes::add(const VertexType& type, PoseOfValues pose) {
  const auto index = static_cast<std::size_t>(type.index());
  if (index >= entries_.size()) entries_.resize(index + 1);
  entries_[index] = {PoseKind::space, pose};
}

PoseKind PoseTypes::kind(const VertexType& type) const {
  const auto index = static_cast<std::size_t>(type.index());
  return index < entries_.size() ? entries_[index].kind : PoseKind::none;
}

SE3<double> PoseTypes::pose(const VertexType& type, const Vertex& vertex) const {
  return entries_[static_cast<std::size_t>(type.index())].pose(type.values(vertex));
}

}  // namespace quiver
