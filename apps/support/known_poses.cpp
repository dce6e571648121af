#include <quiver/apps/support/known_poses.h>

#include <quiver/types_sba/sim3/vertex_sim3_expmap.h>
#include <quiver/types_sba/vertex_cam.h>
#include <quiver/types_sba/vertex_camera_bal.h>

namespace quiver::app {
namespace {

SE3<double> poseOfCam(const double* values) { return Packing<PosedCamera<double>>::load(values).pose; }

/// Of p ↦ s R p + t, camera to world: the scale moves the points, not the centre.
SE3<double> poseOfSimilarity(const double* values) {
  const Sim3<double> similarity = Packing<CameraSimilarity<double>>::load(values).similarity;
  return SE3<double>(similarity.rotation(), similarity.translation());
}

/// The inverse of X ↦ R X + t, world to camera: the centre is −Rᵀ t.
SE3<double> poseOfBal(const double* values) {
  const BalCamera<double> camera = Packing<BalCamera<double>>::load(values);
  const Matrix<double, 3, 3> toWorld = camera.rotation.transpose();
  return SE3<double>(SO3<double>::fromMatrix(toWorld), Vector<double, 3>(-(toWorld * camera.translation)));
}

template <typename V>
void addPose(const Registry& registry, PoseOfValues pose, PoseTypes& types) {
  if (const VertexType* type = registry.findVertexTypeByName(typeName<V>())) types.add(*type, pose);
}

}  // namespace

PoseTypes knownPoses(const Registry& registry) {
  PoseTypes types(registry);
  addPose<VertexCam>(registry, poseOfCam, types);
  addPose<VertexSim3Expmap>(registry, poseOfSimilarity, types);
  addPose<VertexCameraBal>(registry, poseOfBal, types);
  return types;
}

}  // namespace quiver::app
