#include <quiver/apps/simulate/world_route.h>

#include <algorithm>

namespace quiver::app {
namespace {

/// Poses that odometry has just tied together are no loop closures.
constexpr std::int64_t recent = 10;

Stop ahead(Stop stop) {
  constexpr std::int32_t dx[] = {1, 0, -1, 0};
  constexpr std::int32_t dy[] = {0, 1, 0, -1};
  stop.x += dx[stop.quarter];
  stop.y += dy[stop.quarter];
  return stop;
}

Stop turned(Stop stop, int quarters) {
  stop.quarter = (stop.quarter + quarters + 4) % 4;
  return stop;
}

}  // namespace

WorldRoute::WorldRoute(const WorldSettings& settings, std::int64_t side)
    : grid_(settings.kind == WorldKind::grid), half_(side / 2), engine_(settings.seed) {
  stops_.reserve(static_cast<std::size_t>(settings.poses));
  Stop start;
  if (grid_) start.x = start.y = static_cast<std::int32_t>(-half_);
  stops_.push_back(start);
  remember();
}

bool WorldRoute::inside(const Stop& stop) const {
  return stop.x >= -half_ && stop.x <= half_ && stop.y >= -half_ && stop.y <= half_;
}

void WorldRoute::advance() {
  if (grid_) {
    advanceOnGrid();
  } else {
    advanceInCity();
  }
  remember();
}

/// g2o's motion: one metre ahead in 70 % of the steps, a quarter turn to either side in 15 % each, and a turn at the
/// border of the world.
void WorldRoute::advanceInCity() {
  const double chance = static_cast<double>(engine_() >> 11) * 0x1p-53;
  const Stop& stop = stops_.back();
  Stop next = chance < 0.7 ? ahead(stop) : turned(stop, chance < 0.85 ? 1 : -1);
  if (!inside(next)) next = turned(stop, (engine_() >> 11) % 2 == 0 ? 1 : -1);
  stops_.push_back(next);
}

/// Rows from left to right and back, from below to above, then down again the same way.
void WorldRoute::advanceOnGrid() {
  const std::int64_t width = 2 * half_ + 1;
  const std::int64_t period = 2 * width * width - 2;
  std::int64_t k = static_cast<std::int64_t>(stops_.size()) % period;
  const bool back = k >= width * width;
  if (back) k = period - k;
  const std::int64_t row = k / width;
  const std::int64_t column = row % 2 == 0 ? k % width : width - 1 - k % width;
  Stop next;
  next.x = static_cast<std::int32_t>(column - half_);
  next.y = static_cast<std::int32_t>(row - half_);
  const Stop& stop = stops_.back();
  next.quarter = next.x > stop.x ? 0 : next.y > stop.y ? 1 : next.x < stop.x ? 2 : 3;
  stops_.push_back(next);
}

void WorldRoute::remember() {
  // The newest pose of a place that is no longer recent; older ones of the same place are reached through it.
  const auto count = static_cast<std::int64_t>(stops_.size());
  if (count <= recent) return;
  const std::int64_t old = count - 1 - recent;
  const Stop& stop = stops_[static_cast<std::size_t>(old)];
  newest_[cell(stop.x, stop.y)] = old;
}

std::vector<std::int64_t> WorldRoute::earlierVisits() const {
  const Stop& stop = stops_.back();
  std::vector<std::int64_t> visits;
  constexpr int neighbours[][2] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  for (const auto& d : neighbours) {
    Stop other = stop;
    other.x += d[0];
    other.y += d[1];
    if (!inside(other)) continue;
    const auto found = newest_.find(cell(other.x, other.y));
    if (found != newest_.end()) visits.push_back(found->second);
  }
  std::sort(visits.begin(), visits.end());
  return visits;
}

}  // namespace quiver::app
