#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <quiver/quiver.h>

namespace plaza {

using quiver::BaseEdge;
using quiver::BaseVertex;
using quiver::builtinRegistry;
using quiver::EdgeSE2;
using quiver::Graph;
using quiver::Matrix;
using quiver::Registry;
using quiver::SE2;
using quiver::Vector;
using quiver::VertexSE2;

/// A beacon in the plane, in metres.
class VertexBeacon : public BaseVertex<VertexBeacon, 2, Vector<double, 2>> {
 public:
  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return x + delta;
  }
  static constexpr std::array tangent{"x [m]", "y [m]"};
  static Vector<double, 2> place(const Vector<double, 2>& x) { return x; }
};

/// A range in metres from a robot to a beacon, in eight lanes.
class EdgeRange : public BaseEdge<EdgeRange, 1, double, VertexSE2, VertexBeacon> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 1> computeError(const S& range, const SE2<S>& robot, const Vector<S, 2>& beacon) {
    return Vector<S, 1>((beacon - robot.translation()).norm() - range);
  }
};

/// The built-in types and the two above.
inline std::shared_ptr<Registry> makeRegistry() {
  auto registry = builtinRegistry();
  registry->addVertex<VertexBeacon>("VERTEX_BEACON");
  registry->addEdge<EdgeRange>("EDGE_RANGE_SE2_XY");
  return registry;
}

/// A robot that drives a square twice, and what it measures.
class Simulation {
 public:
  explicit Simulation(std::uint32_t seed) : random_(seed) {}

  struct Result {
    Graph graph;
    /// True places of the beacons, by id.
    std::vector<std::pair<std::int64_t, Vector<double, 2>>> beacons;
  };

  /// Poses 0, 1, … by dead reckoning, the first one fixed; beacons from 1000 on, roughly placed.
  Result run() {
    Graph graph(makeRegistry());
    graph.addVertex<VertexSE2>(0, SE2<double>()).setFixed(true);
    SE2<double> truth;
    SE2<double> reckoned;
    const auto beacons = placeBeacons(graph);
    for (std::int64_t id = 1; id <= laps * 4 * stepsPerSide; ++id) {
      const SE2<double> motion(stepLength, 0.0, id % stepsPerSide == 0 ? std::numbers::pi / 2.0 : 0.0);
      truth = truth * motion;
      const SE2<double> odometry(motion.x() + stepSigma * normal_(random_), stepSigma * normal_(random_),
                                 motion.angle() + turnSigma * normal_(random_));
      reckoned = reckoned * odometry;
      graph.addVertex<VertexSE2>(id, reckoned);
      graph.addEdge<EdgeSE2>({id - 1, id}, odometry, odometryInformation());
      for (const auto& [beacon, place] : beacons) measure(graph, id, truth, beacon, place);
    }
    return {std::move(graph), beacons};
  }

 private:
  static constexpr int laps = 2;
  static constexpr int stepsPerSide = 20;
  static constexpr double stepLength = 1.0;  // m
  static constexpr double stepSigma = 0.03;  // m
  static constexpr double turnSigma = 0.01;  // rad
  static constexpr double rangeSigma = 0.1;  // m
  static constexpr double farthest = 18.0;   // m
  static constexpr double roughSigma = 1.0;  // m

  static Matrix<double, 3, 3> odometryInformation() {
    const double step = 1.0 / (stepSigma * stepSigma);
    return Vector<double, 3>(step, step, 1.0 / (turnSigma * turnSigma)).asDiagonal();
  }

  std::vector<std::pair<std::int64_t, Vector<double, 2>>> placeBeacons(Graph& graph) {
    const std::array<Vector<double, 2>, 5> places{Vector<double, 2>(-3.0, -4.0), Vector<double, 2>(24.0, -2.0),
                                                  Vector<double, 2>(22.0, 25.0), Vector<double, 2>(-5.0, 23.0),
                                                  Vector<double, 2>(9.0, 12.0)};
    std::vector<std::pair<std::int64_t, Vector<double, 2>>> beacons;
    for (const Vector<double, 2>& place : places) {
      const auto id = static_cast<std::int64_t>(1000 + beacons.size());
      const Vector<double, 2> rough(place[0] + roughSigma * normal_(random_), place[1] + roughSigma * normal_(random_));
      graph.addVertex<VertexBeacon>(id, rough);
      beacons.emplace_back(id, place);
    }
    return beacons;
  }

  void measure(Graph& graph, std::int64_t id, const SE2<double>& robot, std::int64_t beacon,
               const Vector<double, 2>& place) {
    const double range = (place - robot.translation()).norm();
    if (range > farthest) return;
    graph.addEdge<EdgeRange>({id, beacon}, range + rangeSigma * normal_(random_),
                             Matrix<double, 1, 1>(1.0 / (rangeSigma * rangeSigma)));
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace plaza
