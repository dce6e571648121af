#include "simulated_worlds.h"

#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace quiver::bench {
namespace {

constexpr double translationNoise = 0.01;  // m
constexpr double rotationNoise = 0.005;    // rad

class Noise {
 public:
  double translation() { return translationNoise * normal_(random_); }
  double rotation() { return rotationNoise * normal_(random_); }
  SE2<double> plane() { return SE2<double>(translation(), translation(), rotation()); }
  SE3<double> space() {
    Vector<double, 6> tangent;
    for (int i = 0; i < 3; ++i) tangent[i] = translation();
    for (int i = 3; i < 6; ++i) tangent[i] = rotation();
    return SE3<double>::exp(tangent);
  }

 private:
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};

template <int N>
Matrix<double, N, N> information(int translations) {
  Matrix<double, N, N> omega = Matrix<double, N, N>::Zero();
  for (int i = 0; i < N; ++i) {
    const double deviation = i < translations ? translationNoise : rotationNoise;
    omega(i, i) = 1.0 / (deviation * deviation);
  }
  return omega;
}

/// Crossings on a grid, a block of three steps apart; at each the robot goes left, straight on or right.
std::vector<SE2<double>> streetPath(int poses) {
  std::mt19937_64 random(2);
  constexpr int block = 3;
  const int half = std::max(2, static_cast<int>(std::sqrt(poses / 8.0))) * block;
  std::vector<SE2<double>> path;
  int x = 0;
  int y = 0;
  int heading = 0;
  for (int i = 0; i < poses; ++i) {
    path.emplace_back(x, y, wrapAngle(heading * std::numbers::pi / 2.0));
    if (x % block == 0 && y % block == 0) heading = (heading + static_cast<int>(random() % 3) + 3) % 4;
    for (int turns = 0; turns < 4; ++turns, heading = (heading + 1) % 4) {
      const int nextX = x + (heading == 0) - (heading == 2);
      const int nextY = y + (heading == 1) - (heading == 3);
      if (std::abs(nextX) > half || std::abs(nextY) > half) continue;
      x = nextX;
      y = nextY;
      break;
    }
  }
  return path;
}

}  // namespace

Graph manhattanWorld(int poses, std::shared_ptr<const Registry> registry) {
  Graph graph(std::move(registry));
  Noise noise;
  const std::vector<SE2<double>> path = streetPath(poses);
  const Matrix<double, 3, 3> omega = information<3>(2);
  std::map<std::pair<long, long>, std::int64_t> lastVisit;
  SE2<double> odometry = path.front();
  graph.addVertex<VertexSE2>(0, odometry);
  for (std::int64_t i = 0; i < poses; ++i) {
    const SE2<double>& here = path[static_cast<std::size_t>(i)];
    if (i > 0) {
      const SE2<double> step = path[static_cast<std::size_t>(i - 1)].between(here) * noise.plane();
      odometry = odometry * step;
      graph.addVertex<VertexSE2>(i, odometry);
      graph.addEdge<EdgeSE2>({i - 1, i}, step, omega);
    }
    const auto [last, isNew] = lastVisit.emplace(std::pair(std::lround(here.x()), std::lround(here.y())), i);
    if (isNew) continue;
    if (last->second < i - 1) {
      const SE2<double> seen = path[static_cast<std::size_t>(last->second)].between(here) * noise.plane();
      graph.addEdge<EdgeSE2>({last->second, i}, seen, omega);
    }
    last->second = i;
  }
  return graph;
}

Graph sphereWorld(int poses, std::shared_ptr<const Registry> registry) {
  Graph graph(std::move(registry));
  Noise noise;
  const int laps = static_cast<int>(std::lround(std::sqrt(poses)));
  const double radius = laps / std::numbers::pi;
  std::vector<SE3<double>> path;
  for (int i = 0; i < laps * laps; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / laps;
    const double polar = std::numbers::pi * (0.05 + 0.9 * i / (static_cast<double>(laps) * laps));
    const SO3<double> turn = SO3<double>::exp(Vector<double, 3>(0.0, 0.0, azimuth));
    const SO3<double> tilt = SO3<double>::exp(Vector<double, 3>(0.0, polar, 0.0));
    const SO3<double> rotation = turn * tilt;
    path.emplace_back(rotation, rotation * Vector<double, 3>(0.0, 0.0, radius));
  }
  const Matrix<double, 6, 6> omega = information<6>(3);
  SE3<double> odometry = path.front();
  graph.addVertex<VertexSE3>(0, odometry);
  for (std::int64_t i = 1; i < laps * laps; ++i) {
    const SE3<double>& here = path[static_cast<std::size_t>(i)];
    const SE3<double> step = path[static_cast<std::size_t>(i - 1)].between(here) * noise.space();
    odometry = odometry * step;
    graph.addVertex<VertexSE3>(i, odometry);
    graph.addEdge<EdgeSE3>({i - 1, i}, step, omega);
    if (i < laps) continue;
    const std::int64_t below = i - laps;
    graph.addEdge<EdgeSE3>({below, i}, path[static_cast<std::size_t>(below)].between(here) * noise.space(), omega);
  }
  return graph;
}

}  // namespace quiver::bench
