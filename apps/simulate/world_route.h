#pragma once

#include <cstdint>
#include <random>
#include <unordered_map>
#include <vector>

#include <quiver/apps/simulate/world_settings.h>

namespace quiver::app {

/// A place on the grid of one metre and a heading in quarter turns.
struct Stop {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t quarter = 0;
};

/// The robot's true way, one stop after the other, and who was where before.
class WorldRoute {
 public:
  /// `side` is that of the world, at least 2.
  WorldRoute(const WorldSettings& settings, std::int64_t side);

  const std::vector<Stop>& stops() const { return stops_; }
  /// Moves on by one stop.
  void advance();
  /// Earlier poses at the current place or one metre from it, newest of each place, without the last ten.
  std::vector<std::int64_t> earlierVisits() const;

 private:
  void advanceInCity();
  void advanceOnGrid();
  bool inside(const Stop& stop) const;
  std::int64_t cell(std::int64_t x, std::int64_t y) const { return (y + half_) * (2 * half_ + 1) + x + half_; }
  void remember();

  bool grid_;
  std::int64_t half_;
  std::mt19937_64 engine_;
  std::vector<Stop> stops_;
  std::unordered_map<std::int64_t, std::int64_t> newest_;
};

}  // namespace quiver::app
