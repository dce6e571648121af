// Estimates far larger than what moves them: differences must not vanish in their rounding.
#include <cmath>

#include <gtest/gtest.h>

#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/core/algorithm/optimizer.h>

#include "core_types.h"

namespace quiver {
namespace {

/// A clock: nanoseconds since some time, and its rate.
struct Clock {
  double time = 0.0;
  double drift = 0.0;
};

}  // namespace

template <>
struct Packing<Clock> {
  static constexpr int size = 2, coordinates = 2, dimension = 2;
  template <typename S>
  using Rebind = Clock;
  static void store(const Clock& x, double* out) {
    out[0] = x.time;
    out[1] = x.drift;
  }
  template <typename S>
  static Clock load(const S* in) {
    return {in[0], in[1]};
  }
};

template <>
struct ValueFields<Clock> {
  static std::vector<Field> fields() { return {{"time", "ns", ""}, {"drift", "", ""}}; }
  static void read(FieldReader& reader, Clock& x) {
    x.time = reader.real();
    x.drift = reader.real();
  }
  static void write(const Clock& x, FieldWriter& writer) {
    writer.real(x.time);
    writer.real(x.drift);
  }
};

namespace {

using test::weight;

class VertexClock : public BaseVertex<VertexClock, 2, Clock> {
 public:
  static Clock oplus(const Clock& x, const Vector<double, 2>& delta) { return {x.time + delta[0], x.drift + delta[1]}; }
};
/// At tick m[0] the time was m[1], in microseconds.
class EdgeTick : public BaseEdge<EdgeTick, 1, Vector<double, 2>, VertexClock> {
 public:
  static Vector<double, 1> computeError(const Vector<double, 2>& m, const Clock& x) {
    return Vector<double, 1>(1e-3 * (x.time + (1.0 + x.drift) * m[0] - m[1]));
  }
};

class VertexTime : public BaseVertex<VertexTime, 1, double> {
 public:
  static double oplus(double x, const Vector<double, 1>& delta) { return x + delta[0]; }
};
class EdgeTime : public BaseEdge<EdgeTime, 1, double, VertexTime> {
 public:
  static Vector<double, 1> computeError(double z, double x) { return Vector<double, 1>(1e-3 * (x - z)); }
};

Graph ticks(double noon) {
  auto registry = test::makeRegistry();
  registry->addVertex<VertexClock>("VERTEX_CLOCK");
  registry->addEdge<EdgeTick>("EDGE_TICK");
  Graph graph(registry);
  graph.addVertex<VertexClock>(0, Clock{noon, 0.0});
  for (int k = 0; k < 5; ++k) {
    const double tick = 1e9 * k;
    graph.addEdge<EdgeTick>({0}, Vector<double, 2>(tick, noon + 5000.0 + (1.0 + 1e-6) * tick), weight(1.0));
  }
  return graph;
}

TEST(LargeCoordinates, ValuesOfOnesOwnAreDifferentiatedByTheirSize) {
  for (const double noon : {0.0, 1e9, 1e10, 1e11, 4.32e13}) {
    Graph graph = ticks(noon);
    EXPECT_LT(checkJacobians(graph).worstDeviation(), 1e-3) << noon;
    const Summary summary = optimize(graph);
    EXPECT_EQ(summary.status, Status::converged) << noon << ": " << summary.reason;
    // What a nanosecond's rounding leaves: 0.008 ns at half a day.
    EXPECT_LT(summary.finalChi2, 1e-6) << noon;
    EXPECT_NEAR(graph.vertex<VertexClock>(0).estimate().time - noon, 5000.0, 1.0) << noon;
    EXPECT_NEAR(graph.vertex<VertexClock>(0).estimate().drift, 1e-6, 1e-9) << noon;
  }
}

TEST(LargeCoordinates, SoAreNumbers) {
  for (const double epoch : {1e12, 1e15, 1e17, 1.7e18}) {
    auto registry = test::makeRegistry();
    registry->addVertex<VertexTime>("VERTEX_TIME");
    registry->addEdge<EdgeTime>("EDGE_TIME");
    Graph graph(registry);
    graph.addVertex<VertexTime>(0, epoch);
    graph.addEdge<EdgeTime>({0}, epoch + 1e6, weight(1.0));
    const Summary summary = optimize(graph);
    EXPECT_EQ(summary.status, Status::converged) << epoch << ": " << summary.reason;
    EXPECT_NEAR(graph.vertex<VertexTime>(0).estimate() - epoch, 1e6, 1e-15 * epoch + 1e-3) << epoch;
  }
}

}  // namespace
}  // namespace quiver
