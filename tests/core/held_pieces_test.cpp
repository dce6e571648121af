// Held directions in graphs whose edges are assembled in several pieces: only the pieces that touch them drop columns.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/linear_system.h>
#include <quiver/core/problem/problem.h>
#include <quiver/quiver.h>

namespace quiver {
namespace {

/// A chain with chords and exact measurements, from bent estimates; the angle of one pose is held.
void expectHeldAngle(int held) {
  constexpr int count = 6000;
  Graph graph(builtinRegistry());
  const auto truth = [](int i) { return SE2<double>(0.5 * i, 3.0 * std::sin(0.01 * i), 0.02 * std::cos(0.01 * i)); };
  for (int i = 0; i < count; ++i) {
    const SE2<double> pose = truth(i);
    graph.addVertex<VertexSE2>(i, SE2<double>(pose.translation()[0] + 0.05 * std::sin(i), pose.translation()[1],
                                              pose.angle() + 0.01 * std::cos(3 * i)));
  }
  graph.findVertex(0)->setFixed(true);
  for (int i = 0; i < count; ++i) {
    for (const int j : {i + 1, i + 7}) {
      if (j < count)
        graph.addEdge<EdgeSE2>({i, j}, truth(i).between(truth(j)), 100.0 * Matrix<double, 3, 3>::Identity());
    }
  }
  auto& vertex = graph.vertex<VertexSE2>(held);
  vertex.setFixedDirections(4);
  const Problem problem(graph, {});
  const Options options;
  const auto system = (*graph.registry()->findLinearSystem("block"))(options);
  system->analyze(problem, options, 2);
  (void)system->linearize(problem.state());
  const auto at = [&](int v, int c) { return static_cast<std::size_t>(problem.offset(v) + c); };
  for (int v = 0; v < problem.variables(); ++v) {
    const bool here = problem.vertex(problem.slotOfVariable(v)).id() == held;
    EXPECT_EQ(system->gradient()[at(v, 2)] == 0.0, here) << held << ": " << v;
  }
  // No error depends on what is held: its row of H is that of the identity.
  std::vector<double> unit(static_cast<std::size_t>(problem.scalars()), 1.0);
  std::vector<double> product(unit.size());
  system->multiply(unit, product);
  for (int v = 0; v < problem.variables(); ++v) {
    if (problem.vertex(problem.slotOfVariable(v)).id() == held) EXPECT_EQ(product[at(v, 2)], 1.0) << held;
  }
}

TEST(HeldPieces, WhatIsHeldStays) {
  for (const int held : {1, 1023, 1024, 3000, 5999}) expectHeldAngle(held);
}

}  // namespace
}  // namespace quiver
