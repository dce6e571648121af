#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include <quiver/apps/simulate/normal_noise.h>
#include <quiver/apps/simulate/world_landmarks.h>
#include <quiver/apps/simulate/world_route.h>
#include <quiver/apps/simulate/world_settings.h>
#include <quiver/apps/simulate/world_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/geometry/se2.h>
#include <quiver/geometry/se3.h>

namespace quiver::app {
namespace {

using Planar = SE2<double>;
using Pose = SE3<double>;
using Vector2 = Vector<double, 2>;
using Vector3 = Vector<double, 3>;
using Vector6 = Vector<double, 6>;

// g2o's simulators: information matrices are diagonal.
constexpr std::array planarInformation{500.0, 500.0, 5000.0};
constexpr std::array spatialInformation{100.0, 100.0, 100.0, 1e4, 1e4, 1e4};
constexpr double pointInformation = 1000.0;
constexpr double gpsInformation = 1.0;
constexpr double compassInformation = 1000.0;
constexpr double pixelInformation = 1.0;
constexpr double depthInformation = 100.0;
constexpr double disparityInformation = 1000.0;
constexpr double focal = 500.0, centreU = 320.0, centreV = 240.0;
/// Keeps identity offset and the camera, whose z axis looks ahead, its x axis to the right.
constexpr std::int64_t identityParameter = 0, cameraParameter = 1, cameraOffsetParameter = 2;

std::array<double, 7> valuesOf(const Pose& pose) {
  const auto v = pose.toVector();
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
}
std::array<double, 3> valuesOf(const Planar& pose) { return {pose.x(), pose.y(), pose.angle()}; }

/// The camera in the robot's frame: 0.3 m above it.
Pose cameraOffset() { return Pose(0.0, 0.0, 0.3, -0.5, 0.5, -0.5, 0.5); }

Planar planarPose(const Stop& stop) { return Planar(stop.x, stop.y, wrapAngle(stop.quarter * std::numbers::pi / 2)); }
Pose spatialPose(const Stop& stop) {
  const double half = stop.quarter * std::numbers::pi / 4;
  return Pose(stop.x, stop.y, 0.0, 0.0, 0.0, std::sin(half), std::cos(half));
}

/// Both files: the measured graph, and the true one if it is asked for. They differ in the estimates alone.
class World {
 public:
  World(const WorldSettings& settings, std::int64_t side, const std::string& output, const std::string& truth)
      : settings_(settings),
        spatial_(settings.kind == WorldKind::landmarks3d),
        route_(settings, side),
        landmarks_(settings, side),
        noise_(settings.seed ^ 0x9e3779b97f4a7c15u),
        measured_(output) {
    if (!truth.empty()) truth_.emplace(truth);
  }

  WorldCounts run() {
    if (spatial_) writeParameters();
    for (std::int64_t i = 0; i < settings_.poses; ++i) {
      if (i > 0) route_.advance();
      spatial_ ? stepInSpace(i) : stepInPlane(i);
    }
    measured_.commit();
    if (truth_) truth_->commit();
    counts_.poses = settings_.poses;
    return counts_;
  }

 private:
  void both(std::string_view tag, std::initializer_list<std::int64_t> ids, std::span<const double> values = {},
            std::span<const double> information = {}) {
    measured_.line(tag, ids, values, information);
    if (truth_) truth_->line(tag, ids, values, information);
  }
  void edge(std::string_view tag, std::initializer_list<std::int64_t> ids, std::span<const double> values,
            std::span<const double> information) {
    both(tag, ids, values, information);
    ++counts_.edges;
  }
  void vertex(std::string_view tag, std::int64_t id, std::span<const double> estimate, std::span<const double> truth) {
    measured_.line(tag, {id}, estimate);
    if (truth_) truth_->line(tag, {id}, truth);
  }
  double noisy(double value, double information) { return value + noise_.next() / std::sqrt(information); }

  void writeParameters() {
    constexpr std::array identity{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
    both("PARAMS_SE3OFFSET", {identityParameter}, identity);
    const std::array offset = valuesOf(cameraOffset());
    std::array<double, 11> camera{};
    std::copy(offset.begin(), offset.end(), camera.begin());
    const std::array intrinsics{focal, focal, centreU, centreV};
    std::copy(intrinsics.begin(), intrinsics.end(), camera.begin() + 7);
    both("PARAMS_CAMERACALIB", {cameraParameter}, camera);
    both("PARAMS_SE3OFFSET", {cameraOffsetParameter}, offset);
  }

  Planar disturbed(const Planar& exact) {
    Vector3 v;
    for (int k = 0; k < 3; ++k) v[k] = noise_.next() / std::sqrt(planarInformation[static_cast<std::size_t>(k)]);
    return exact * Planar(v[0], v[1], v[2]);
  }
  /// The residual holds the vector of the quaternion, half a small rotation's vector.
  Pose disturbed(const Pose& exact) {
    Vector3 shift, turn;
    for (int k = 0; k < 3; ++k) {
      shift[k] = noise_.next() / std::sqrt(spatialInformation[static_cast<std::size_t>(k)]);
      turn[k] = 2.0 * noise_.next() / std::sqrt(spatialInformation[static_cast<std::size_t>(k + 3)]);
    }
    return exact * Pose(SO3<double>::exp(turn), shift);
  }

  void stepInPlane(std::int64_t i) {
    const Planar truth = planarPose(route_.stops().back());
    Planar step;
    if (i > 0) {
      step = disturbed(planarPose(route_.stops()[static_cast<std::size_t>(i - 1)]).between(truth));
      planar_ = planar_ * step;
    } else {
      planar_ = truth;
    }
    vertex("VERTEX_SE2", i, valuesOf(planar_), valuesOf(truth));
    if (i == 0) both("FIX", {0});
    if (i > 0 && settings_.odometry) edge("EDGE_SE2", {i - 1, i}, valuesOf(step), planarInformation);
    if (settings_.poseSensor) {
      for (const std::int64_t j : route_.earlierVisits())
        edge("EDGE_SE2", {j, i},
             valuesOf(disturbed(planarPose(route_.stops()[static_cast<std::size_t>(j)]).between(truth))),
             planarInformation);
    }
    if (settings_.gps)
      edge("EDGE_PRIOR_SE2_XY", {i}, std::array{noisy(truth.x(), gpsInformation), noisy(truth.y(), gpsInformation)},
           std::array{gpsInformation, gpsInformation});
    // The heading alone: a prior that weighs no translation.
    if (settings_.compass)
      edge("EDGE_PRIOR_SE2", {i}, std::array{0.0, 0.0, wrapAngle(noisy(truth.angle(), compassInformation))},
           std::array{0.0, 0.0, compassInformation});
    if (settings_.pointSensor || settings_.bearingSensor) seeInPlane(i, truth);
  }

  void seeInPlane(std::int64_t i, const Planar& truth) {
    constexpr double range = 5.0, halfView = 0.375 * std::numbers::pi;
    for (const std::int64_t l : landmarks_.near(truth.x(), truth.y(), range)) {
      const Vector2 place = landmarks_.place(l).head<2>();
      const Vector2 exact = truth.actInverse(place);
      const double bearing = std::atan2(exact[1], exact[0]);
      if (exact.norm() > range || std::abs(bearing) > halfView) continue;
      const Vector2 seen(noisy(exact[0], pointInformation), noisy(exact[1], pointInformation));
      const std::int64_t id = settings_.poses + l;
      if (landmarks_.firstSeen(l)) {
        const Vector2 guess = planar_ * seen;
        vertex("VERTEX_XY", id, std::array{guess[0], guess[1]}, std::array{place[0], place[1]});
        ++counts_.landmarks;
      }
      if (settings_.pointSensor)
        edge("EDGE_SE2_XY", {i, id}, std::array{seen[0], seen[1]}, std::array{pointInformation, pointInformation});
      if (settings_.bearingSensor)
        edge("EDGE_BEARING_SE2_XY", {i, id}, std::array{wrapAngle(noisy(bearing, pointInformation))},
             std::array{pointInformation});
    }
  }

  void stepInSpace(std::int64_t i) {
    const Pose truth = spatialPose(route_.stops().back());
    Pose step;
    if (i > 0) {
      step = disturbed(spatialPose(route_.stops()[static_cast<std::size_t>(i - 1)]).between(truth));
      pose_ = Pose((pose_ * step).rotation().renormalised(), (pose_ * step).translation());
    } else {
      pose_ = truth;
    }
    vertex("VERTEX_SE3:QUAT", i, valuesOf(pose_), valuesOf(truth));
    if (i == 0) both("FIX", {0});
    if (i > 0 && settings_.odometry) edge("EDGE_SE3:QUAT", {i - 1, i}, valuesOf(step), spatialInformation);
    if (settings_.poseSensor) {
      for (const std::int64_t j : route_.earlierVisits())
        edge("EDGE_SE3:QUAT", {j, i},
             valuesOf(disturbed(spatialPose(route_.stops()[static_cast<std::size_t>(j)]).between(truth))),
             spatialInformation);
    }
    if (settings_.gps) {
      const Vector3 t = truth.translation();
      edge("EDGE_SE3_XYZ_PRIOR", {i, identityParameter},
           std::array{noisy(t[0], gpsInformation), noisy(t[1], gpsInformation), noisy(t[2], gpsInformation)},
           std::array{gpsInformation, gpsInformation, gpsInformation});
    }
    if (settings_.compass) {
      Vector3 turn;
      for (int k = 0; k < 3; ++k) turn[k] = 2.0 * noise_.next() / std::sqrt(compassInformation);
      edge("EDGE_SE3_PRIOR", {i, identityParameter},
           valuesOf(Pose(truth.rotation() * SO3<double>::exp(turn), Vector3::Zero())),
           std::array{0.0, 0.0, 0.0, compassInformation, compassInformation, compassInformation});
    }
    if (settings_.pointSensor || settings_.depthSensor || settings_.disparitySensor) seeInSpace(i, truth);
  }

  void seeInSpace(std::int64_t i, const Pose& truth) {
    constexpr double nearest = 0.5, farthest = 5.0;
    const Pose camera = truth * cameraOffset();
    const Pose guessed = pose_ * cameraOffset();
    for (const std::int64_t l : landmarks_.near(truth.translation()[0], truth.translation()[1], farthest)) {
      const Vector3 exact = camera.actInverse(landmarks_.place(l));
      if (exact[2] < nearest || exact.norm() > farthest || std::hypot(exact[0], exact[1]) > exact[2]) continue;
      Vector3 seen;
      for (int k = 0; k < 3; ++k) seen[k] = noisy(exact[k], pointInformation);
      const std::int64_t id = settings_.poses + l;
      if (landmarks_.firstSeen(l)) {
        const Vector3 guess = guessed * seen;
        const Vector3 place = landmarks_.place(l);
        vertex("VERTEX_TRACKXYZ", id, std::array{guess[0], guess[1], guess[2]},
               std::array{place[0], place[1], place[2]});
        ++counts_.landmarks;
      }
      writeSight(i, id, exact, seen);
    }
  }

  void writeSight(std::int64_t i, std::int64_t id, const Vector3& exact, const Vector3& seen) {
    const double u = focal * exact[0] / exact[2] + centreU, v = focal * exact[1] / exact[2] + centreV;
    if (settings_.pointSensor)
      edge("EDGE_SE3_TRACKXYZ", {i, id, cameraOffsetParameter}, std::array{seen[0], seen[1], seen[2]},
           std::array{pointInformation, pointInformation, pointInformation});
    if (settings_.depthSensor)
      edge("EDGE_PROJECT_DEPTH", {i, id, cameraParameter},
           std::array{noisy(u, pixelInformation), noisy(v, pixelInformation), noisy(exact[2], depthInformation)},
           std::array{pixelInformation, pixelInformation, depthInformation});
    if (settings_.disparitySensor)
      edge("EDGE_PROJECT_DISPARITY", {i, id, cameraParameter},
           std::array{noisy(u, pixelInformation), noisy(v, pixelInformation),
                      noisy(1.0 / exact[2], disparityInformation)},
           std::array{pixelInformation, pixelInformation, disparityInformation});
  }

  const WorldSettings& settings_;
  bool spatial_;
  WorldRoute route_;
  WorldLandmarks landmarks_;
  NormalNoise noise_;
  WorldWriter measured_;
  std::optional<WorldWriter> truth_;
  Planar planar_;
  Pose pose_;
  WorldCounts counts_;
};

}  // namespace

WorldCounts simulateWorld(const WorldSettings& settings, const std::string& output, const std::string& truth) {
  constexpr std::int64_t mostPoses = 100'000'000, largestSide = 1'000'000;
  if (settings.poses < 2 || settings.poses > mostPoses)
    throw GraphError(fmt::format("a simulated world has 2 to {} poses, not {}", mostPoses, settings.poses));
  if (settings.side != 0 && (settings.side < 2 || settings.side > largestSide))
    throw GraphError(fmt::format("the side of a world is 2 to {} metres, not {}", largestSide, settings.side));
  if (settings.landmarks < 0) throw GraphError("the number of landmarks must not be negative");
  if (!settings.odometry) throw GraphError("without odometry nothing ties the poses together");
  std::int64_t side = settings.side;
  if (side == 0) {
    const double visits = settings.kind == WorldKind::grid ? 1.0 : 3.0;
    side = std::max<std::int64_t>(2, std::llround(std::ceil(std::sqrt(static_cast<double>(settings.poses) / visits))));
  }
  return World(settings, side, output, truth).run();
}

}  // namespace quiver::app
