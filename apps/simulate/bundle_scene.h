#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <quiver/geometry/linear.h>
#include <quiver/types_sba/vertex_camera_bal.h>

namespace quiver::app {

/// A made-up bundle adjustment problem.
struct BundleSettings {
  /// "loop": cameras on a circle look outwards, in rounds. "city": cameras drive round the blocks of a city and look
  /// ahead and to the right.
  std::string scene = "loop";
  int cameras = 200;
  std::int64_t points = 20000;
  /// Observations of a point on average, at least 2.
  double trackLength = 4.0;
  /// Times that the same way is gone.
  int rounds = 2;
  /// Standard deviation of a pixel.
  double pixelNoise = 0.5;
  /// Share of the observations, from 0 to 1, whose pixel is anywhere in the image.
  double outliers = 0.0;
  /// Standard deviations of the first estimates: rotations [rad], positions of cameras and points [m].
  double rotationError = 0.002;
  double positionError = 0.05;
  double pointError = 0.3;
  std::uint64_t seed = 0;
};

/// Throws GraphError naming the first setting that makes no sense.
void check(const BundleSettings& settings);

/// Random numbers of one element, the same however the others are visited (SplitMix64, a permutation of a counter).
class ElementRandom {
 public:
  /// `stream` keeps apart what the same element draws for different ends.
  ElementRandom(std::uint64_t seed, std::uint64_t element, std::uint64_t stream);
  /// In (0, 1].
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal.
  double normal();
  Vector<double, 3> normal3(double deviation);

 private:
  std::uint64_t state_;
};

/// One pixel of a point.
struct Sighting {
  int camera;
  Vector<double, 2> pixel;
};

/// The truth: cameras, and points that are made when they are asked for, so a scene of any number of points takes the
/// memory of its cameras. Thread safe.
class BundleScene {
 public:
  /// Half the image, which is centred at 0 [px].
  static constexpr double halfWidth = 600.0, halfHeight = 450.0;

  explicit BundleScene(const BundleSettings& settings);

  int cameras() const { return static_cast<int>(cameras_.size()); }
  const BalCamera<double>& camera(int i) const { return cameras_[static_cast<std::size_t>(i)]; }

  /// The position of a point and, in ascending order, the cameras that track it: at least two, all of which see it.
  /// Throws GraphError if no point that two cameras see is found.
  Vector<double, 3> point(std::int64_t index, std::vector<int>& track) const;

 private:
  void placeOnLoop(const BundleSettings& settings);
  void placeInCity(const BundleSettings& settings);
  void place(const Vector<double, 3>& position, const Vector<double, 3>& forward);
  void findNeighbours();
  bool sees(int camera, const Vector<double, 3>& point) const;

  BundleSettings settings_;
  std::vector<BalCamera<double>> cameras_;
  std::vector<Vector<double, 3>> positions_;
  /// The nearest cameras of each, itself first.
  std::vector<std::vector<std::int32_t>> neighbours_;
};

}  // namespace quiver::app
