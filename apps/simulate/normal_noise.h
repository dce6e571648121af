#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include <quiver/geometry/linear.h>

namespace quiver::app {

/// Normal random numbers that are the same with every standard library: the distributions of <random> are not.
class NormalNoise {
 public:
  explicit NormalNoise(std::uint64_t seed) : engine_(seed) {}

  /// Standard normal, by Box and Muller's polar angle and radius.
  double next() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  Vector<double, 3> next3(const Vector<double, 3>& deviations) {
    Vector<double, 3> sample;
    for (int i = 0; i < 3; ++i) sample[i] = deviations[i] * next();
    return sample;
  }

 private:
  /// In (0, 1].
  double uniform() { return static_cast<double>((engine_() >> 11) + 1) * 0x1p-53; }

  std::mt19937_64 engine_;
};

}  // namespace quiver::app
