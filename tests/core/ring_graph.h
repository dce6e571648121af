#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "core_types.h"

namespace quiver::test {

/// Poses on a circle with odometry and loops, points around it with ranges of type E, all slightly off and unfixed. Ids
/// of points begin at 1000. With a seed, vertices and edges are added in an order of its own.
template <typename E>
Graph ringGraph(int poses, int points, unsigned shuffleSeed = 0) {
  struct Addition {
    std::int64_t from, to;
    SE2<double> motion;
    double range;
  };
  std::mt19937 noise(7);
  std::normal_distribution<double> normal;
  const auto pose = [&](int i) {
    const double angle = 2.0 * std::numbers::pi * i / poses;
    return SE2<double>(10.0 * std::cos(angle), 10.0 * std::sin(angle), angle + std::numbers::pi / 2.0);
  };
  std::vector<std::pair<std::int64_t, SE2<double>>> starts;
  std::vector<Addition> additions;
  for (int i = 0; i < poses; ++i) {
    const Vector<double, 3> off(0.2 * normal(noise), 0.2 * normal(noise), 0.05 * normal(noise));
    starts.emplace_back(i, pose(i).retract(off));
    for (const int step : {1, 5}) {
      const Vector<double, 3> error(0.02 * normal(noise), 0.02 * normal(noise), 0.01 * normal(noise));
      additions.push_back({i, (i + step) % poses, pose(i).between(pose((i + step) % poses)).retract(error), 0.0});
    }
  }
  for (int p = 0; p < points; ++p) {
    const Vector<double, 2> place(15.0 * std::cos(p), 13.0 * std::sin(p));
    starts.emplace_back(1000 + p, SE2<double>(place[0] + normal(noise), place[1] + normal(noise), 0.0));
    for (int i = p % 3; i < poses; i += 3)
      additions.push_back({i, 1000 + p, {}, (place - pose(i).translation()).norm() + 0.05 * normal(noise)});
  }
  if (shuffleSeed > 0) {
    std::mt19937 shuffle(shuffleSeed);
    std::shuffle(starts.begin(), starts.end(), shuffle);
    std::shuffle(additions.begin(), additions.end(), shuffle);
  }
  Graph graph(makeRegistry());
  for (const auto& [id, start] : starts) {
    if (id < 1000) {
      graph.addVertex<VertexSE2>(id, start);
    } else {
      graph.addVertex<VertexPoint>(id, start.translation());
    }
  }
  const Matrix<double, 3, 3> information = Vector<double, 3>(2500.0, 2500.0, 10000.0).asDiagonal();
  for (const Addition& a : additions) {
    if (a.to < 1000) {
      graph.addEdge<EdgeSE2>({a.from, a.to}, a.motion, information);
    } else {
      graph.addEdge<E>({a.from, a.to}, a.range, weight(400.0));
    }
  }
  return graph;
}

/// All estimates, in the order of ids.
inline std::vector<double> estimates(const Graph& graph, int poses, int points) {
  std::vector<double> values;
  for (int i = 0; i < poses; ++i) {
    const Vector<double, 3> x = graph.vertex<VertexSE2>(i).estimate().toVector();
    values.insert(values.end(), x.data(), x.data() + 3);
  }
  for (int p = 0; p < points; ++p) {
    const Vector<double, 2> x = graph.vertex<VertexPoint>(1000 + p).estimate();
    values.insert(values.end(), x.data(), x.data() + 2);
  }
  return values;
}

}  // namespace quiver::test
