#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <unordered_map>
#include <vector>

#include <quiver/apps/simulate/world_settings.h>
#include <quiver/geometry/linear.h>

namespace quiver::app {

/// Points strewn evenly over the world (in space: up to 1.5 m high), found by place.
class WorldLandmarks {
 public:
  WorldLandmarks(const WorldSettings& settings, std::int64_t side) {
    const bool spatial = settings.kind == WorldKind::landmarks3d;
    if (!spatial && settings.kind != WorldKind::landmarks2d) return;
    std::mt19937_64 engine(settings.seed + 1);
    const auto uniform = [&engine] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
    const double width = static_cast<double>(side);
    for (std::int64_t l = 0; l < settings.landmarks; ++l) {
      const double x = width * (uniform() - 0.5), y = width * (uniform() - 0.5);
      const double z = spatial ? 1.5 * uniform() : 0.0;
      cells_[cell(floorOf(x), floorOf(y))].push_back(l);
      places_.emplace_back(x, y, z);
    }
    seen_.assign(places_.size(), false);
  }

  const Vector<double, 3>& place(std::int64_t landmark) const { return places_[static_cast<std::size_t>(landmark)]; }
  /// Ascending; all those within the range and some around it.
  std::vector<std::int64_t> near(double x, double y, double range) const {
    std::vector<std::int64_t> found;
    for (std::int64_t row = floorOf(y - range); row <= floorOf(y + range); ++row) {
      for (std::int64_t column = floorOf(x - range); column <= floorOf(x + range); ++column) {
        const auto entry = cells_.find(cell(column, row));
        if (entry != cells_.end()) found.insert(found.end(), entry->second.begin(), entry->second.end());
      }
    }
    std::sort(found.begin(), found.end());
    return found;
  }
  /// Whether nobody has asked about it before.
  bool firstSeen(std::int64_t landmark) {
    const bool first = !seen_[static_cast<std::size_t>(landmark)];
    seen_[static_cast<std::size_t>(landmark)] = true;
    return first;
  }

 private:
  static std::int64_t floorOf(double value) { return static_cast<std::int64_t>(std::floor(value)); }
  static std::int64_t cell(std::int64_t x, std::int64_t y) { return y * (std::int64_t{1} << 32) + x; }

  std::vector<Vector<double, 3>> places_;
  std::unordered_map<std::int64_t, std::vector<std::int64_t>> cells_;
  std::vector<bool> seen_;
};

}  // namespace quiver::app
