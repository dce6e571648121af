#include <quiver/apps/simulate/bundle_scene.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <quiver/core/util/error.h>

namespace quiver::app {
namespace {

using Vector3 = Vector<double, 3>;

/// Metres between cameras of one round, and to how far a camera sees.
constexpr double spacing = 1.0;
constexpr double nearest = 2.0, farthest = 60.0;
/// Points are made at these depths of a camera.
constexpr double nearestPoint = 5.0, farthestPoint = 30.0;
/// Cameras farther from each other than this share no points; so many at most are asked.
constexpr double reach = 20.0;
constexpr std::size_t mostNeighbours = 192;

}  // namespace

void check(const BundleSettings& s) {
  const auto refuse = [](const std::string& what) { throw GraphError("a simulated bundle needs " + what); };
  const auto sound = [](double value) { return value >= 0.0 && std::isfinite(value); };
  if (s.scene != "loop" && s.scene != "city") refuse(fmt::format("a scene loop or city, not '{}'", s.scene));
  if (s.rounds < 1) refuse(fmt::format("at least 1 round, not {}", s.rounds));
  if (s.cameras < 2 * s.rounds) refuse(fmt::format("at least 2 cameras a round, not {} in {}", s.cameras, s.rounds));
  if (s.points < 1) refuse(fmt::format("at least 1 point, not {}", s.points));
  if (!(s.trackLength >= 2.0) || !std::isfinite(s.trackLength))
    refuse(fmt::format("tracks of at least 2 observations, not {}", s.trackLength));
  if (!(s.outliers >= 0.0 && s.outliers <= 1.0))
    refuse(fmt::format("a share of outliers in [0, 1], not {}", s.outliers));
  if (!sound(s.pixelNoise) || !sound(s.rotationError) || !sound(s.positionError) || !sound(s.pointError))
    refuse("deviations that are finite and not negative");
}

ElementRandom::ElementRandom(std::uint64_t seed, std::uint64_t element, std::uint64_t stream)
    : state_(seed * 0x9e3779b97f4a7c15u + element * 0xd1342543de82ef95u + stream * 0xda942042e4dd58b5u) {
  uniform();
}

double ElementRandom::uniform() {
  std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return static_cast<double>((z >> 11) + 1) * 0x1p-53;
}

double ElementRandom::normal() {
  const double radius = std::sqrt(-2.0 * std::log(uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

Vector3 ElementRandom::normal3(double deviation) {
  const double x = deviation * normal(), y = deviation * normal();
  return Vector3(x, y, deviation * normal());
}

BundleScene::BundleScene(const BundleSettings& settings) : settings_(settings) {
  check(settings);
  if (settings.scene == "loop") {
    placeOnLoop(settings);
  } else {
    placeInCity(settings);
  }
  findNeighbours();
}

/// The camera looks along −z with y up.
void BundleScene::place(const Vector3& position, const Vector3& forward) {
  const Vector3 back = -forward.normalized();
  const Vector3 right = Vector3(0.0, 0.0, 1.0).cross(back).normalized();
  Matrix<double, 3, 3> R;
  R.row(0) = right;
  R.row(1) = back.cross(right);
  R.row(2) = back;
  ElementRandom random(settings_.seed, cameras_.size(), 1);
  const Vector3 intrinsics(800.0 * random.uniform(0.98, 1.02), random.uniform(-0.06, -0.04), random.uniform(0.0, 0.02));
  cameras_.emplace_back(R, -(R * position), intrinsics);
  positions_.push_back(position);
}

/// Each round is a little higher and wider than the one before.
void BundleScene::placeOnLoop(const BundleSettings& settings) {
  const int perRound = (settings.cameras + settings.rounds - 1) / settings.rounds;
  const double radius = std::max(3.0, perRound * spacing / (2.0 * std::numbers::pi));
  for (int i = 0; i < settings.cameras; ++i) {
    const int round = i / perRound;
    const double angle = 2.0 * std::numbers::pi * (i % perRound + 0.3 * round) / perRound;
    const Vector3 outwards(std::cos(angle), std::sin(angle), 0.0);
    place((radius + 0.2 * round) * outwards + Vector3(0.0, 0.0, 0.3 * round), outwards + Vector3(0.0, 0.0, 0.05));
  }
}

/// Blocks of 60 m in a square, a street of 20 m between them, in whose middle the cameras drive round each block.
void BundleScene::placeInCity(const BundleSettings& settings) {
  constexpr double side = 80.0;
  constexpr int perSide = static_cast<int>(side / spacing), perBlock = 4 * perSide;
  const int perRound = (settings.cameras + settings.rounds - 1) / settings.rounds;
  const int blocks = (perRound + perBlock - 1) / perBlock;
  const int width = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(blocks))));
  const Vector3 along[4] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}};
  for (int i = 0; i < settings.cameras; ++i) {
    const int round = i / perRound, step = i % perRound;
    const int block = step / perBlock, leg = step % perBlock / perSide;
    Vector3 position(side * (block % width), side * (block / width), 1.5 + 0.2 * round);
    for (int k = 0; k < leg; ++k) position += side * along[k];
    position += (step % perSide + 0.3 * round) * spacing * along[leg];
    const Vector3 ahead = along[leg], right(ahead[1], -ahead[0], 0.0);
    place(position + 0.3 * round * right, ahead + 0.6 * right);
  }
}

void BundleScene::findNeighbours() {
  // Cells as wide as the reach: neighbours are in the same or an adjacent one.
  const auto cellOf = [](double x) { return static_cast<std::int64_t>(std::floor(x / reach)); };
  const auto key = [](std::int64_t x, std::int64_t y) { return x * 1000003 + y; };
  std::unordered_map<std::int64_t, std::vector<std::int32_t>> cells;
  for (std::size_t i = 0; i < positions_.size(); ++i)
    cells[key(cellOf(positions_[i][0]), cellOf(positions_[i][1]))].push_back(static_cast<std::int32_t>(i));
  neighbours_.resize(positions_.size());
  std::vector<std::pair<double, std::int32_t>> near;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    near.clear();
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto found = cells.find(key(cellOf(positions_[i][0]) + dx, cellOf(positions_[i][1]) + dy));
        if (found == cells.end()) continue;
        for (const std::int32_t j : found->second) {
          const double distance = (positions_[static_cast<std::size_t>(j)] - positions_[i]).norm();
          if (distance <= reach) near.emplace_back(distance, j);
        }
      }
    }
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), mostNeighbours));
    for (const auto& [distance, j] : near) neighbours_[i].push_back(j);
  }
}

bool BundleScene::sees(int camera, const Vector3& point) const {
  const BalCamera<double>& c = this->camera(camera);
  const Vector3 p = c.seen(point);
  if (!(-p[2] >= nearest && -p[2] <= farthest)) return false;
  const Vector<double, 2> pixel = CameraSnavely::project<double>(c.intrinsics, p);
  return std::abs(pixel[0]) <= halfWidth && std::abs(pixel[1]) <= halfHeight;
}

/// A point anywhere in the view of one camera; tracked by it and by those that are near it, chosen with some luck.
Vector3 BundleScene::point(std::int64_t index, std::vector<int>& track) const {
  constexpr int trials = 1000;
  ElementRandom random(settings_.seed, static_cast<std::uint64_t>(index), 2);
  std::vector<std::pair<double, int>> candidates;
  for (int trial = 0; trial < trials; ++trial) {
    const int anchor = std::min(cameras() - 1, static_cast<int>(random.uniform() * cameras()));
    const BalCamera<double>& camera = this->camera(anchor);
    const Vector<double, 2> pixel(random.uniform(-halfWidth, halfWidth), random.uniform(-halfHeight, halfHeight));
    const double depth = random.uniform(nearestPoint, farthestPoint);
    const Vector3 inCamera = depth * CameraSnavely::unproject<double>(camera.intrinsics, pixel);
    const Vector3 position = camera.rotation.transpose() * (inCamera - camera.translation);
    // 2 + a geometric number with the wanted mean.
    const double extra = settings_.trackLength - 2.0;
    const double draw = random.uniform();
    const auto length = static_cast<std::size_t>(
        extra > 0.0 ? 2.0 + std::floor(std::log(draw) / std::log(extra / (1.0 + extra))) : 2.0);
    candidates.clear();
    const auto& neighbours = neighbours_[static_cast<std::size_t>(anchor)];
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      if (sees(neighbours[k], position))
        candidates.emplace_back(static_cast<double>(k) * random.uniform(0.3, 1.0), neighbours[k]);
    }
    if (candidates.size() < 2) continue;
    const std::size_t count = std::min(length, candidates.size());
    std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count), candidates.end());
    track.clear();
    for (std::size_t k = 0; k < count; ++k) track.push_back(candidates[k].second);
    std::sort(track.begin(), track.end());
    return position;
  }
  throw GraphError("no point of this scene is seen by two cameras: there are too few of them");
}

}  // namespace quiver::app
