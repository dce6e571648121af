#include <quiver/apps/simulate/sphere.h>

#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include <quiver/apps/simulate/normal_noise.h>
#include <quiver/core/util/error.h>
#include <quiver/types_slam3d/edge_se3.h>

namespace quiver::app {
namespace {

using Pose = SE3<double>;
using Rotation = SO3<double>;
using Vector3 = Vector<double, 3>;

void check(const SphereSettings& settings) {
  if (settings.laps < 1 || settings.nodesPerLap < 3) {
    throw GraphError(
        fmt::format("a sphere needs at least 1 lap of 3 nodes, not {} of {}", settings.laps, settings.nodesPerLap));
  }
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  bool sound = positive(settings.radius);
  for (int i = 0; i < 3; ++i)
    sound = sound && positive(settings.translationNoise[i]) && positive(settings.rotationNoise[i]);
  if (!sound) throw GraphError("a sphere's radius and the deviations of its noise must be positive and finite");
}

/// Longitude turns once a lap, latitude rises from pole to pole; the body's x axis points away from the centre.
std::vector<Pose> truePoses(const SphereSettings& settings) {
  const int count = settings.laps * settings.nodesPerLap;
  std::vector<Pose> poses;
  poses.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double longitude = 2.0 * std::numbers::pi * (i % settings.nodesPerLap) / settings.nodesPerLap;
    const double latitude = std::numbers::pi * (static_cast<double>(i) / count - 0.5);
    const Rotation rotation = Rotation::exp(Vector3(0.0, 0.0, longitude)) * Rotation::exp(Vector3(0.0, -latitude, 0.0));
    poses.emplace_back(rotation, rotation * Vector3(settings.radius, 0.0, 0.0));
  }
  return poses;
}

/// The first pose is followed by the next one, and sees the three nearest ones of the next lap.
std::vector<std::pair<int, int>> measuredPairs(const SphereSettings& settings) {
  const int count = settings.laps * settings.nodesPerLap;
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i + 1 < count; ++i) pairs.emplace_back(i, i + 1);
  for (int i = 0; i < count - settings.nodesPerLap; ++i) {
    for (int to = i + settings.nodesPerLap - 1; to <= i + settings.nodesPerLap + 1 && to < count; ++to)
      pairs.emplace_back(i, to);
  }
  return pairs;
}

/// A small rotation's quaternion vector is half its rotation vector.
Matrix<double, 6, 6> informationOf(const SphereSettings& settings) {
  Matrix<double, 6, 6> information = Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 3; ++i) {
    information(i, i) = 1.0 / (settings.translationNoise[i] * settings.translationNoise[i]);
    information(i + 3, i + 3) = 4.0 / (settings.rotationNoise[i] * settings.rotationNoise[i]);
  }
  return information;
}

}  // namespace

SimulatedGraph simulateSphere(const SphereSettings& settings, std::shared_ptr<const Registry> registry) {
  check(settings);
  const std::vector<Pose> poses = truePoses(settings);
  Graph truth(std::move(registry));
  for (std::size_t i = 0; i < poses.size(); ++i) truth.addVertex<VertexSE3>(static_cast<std::int64_t>(i), poses[i]);
  truth.vertex<VertexSE3>(0).setFixed(true);
  Graph measured(truth);

  NormalNoise noise(settings.seed);
  const Matrix<double, 6, 6> information = informationOf(settings);
  Pose estimate = poses[0];
  for (const auto& [from, to] : measuredPairs(settings)) {
    const Pose exact = poses[static_cast<std::size_t>(from)].between(poses[static_cast<std::size_t>(to)]);
    const Vector3 shift = noise.next3(settings.translationNoise);
    const Vector3 turn = noise.next3(settings.rotationNoise);
    const Pose measurement = exact * Pose(Rotation::exp(turn), shift);
    for (Graph* graph : {&truth, &measured}) graph->addEdge<EdgeSE3>({from, to}, measurement, information);
    if (to != from + 1) continue;
    estimate = estimate * measurement;
    estimate = Pose(estimate.rotation().renormalised(), estimate.translation());
    measured.vertex<VertexSE3>(to).setEstimate(estimate);
  }
  return {std::move(measured), std::move(truth)};
}

}  // namespace quiver::app
