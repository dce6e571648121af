#include <quiver/core/problem/canonical_order.h>

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "core_types.h"

namespace quiver {
namespace {

using namespace test;

/// What the order of edges is by definition: ids first, then the numbers of the measurement.
struct EdgeLine {
  std::vector<std::int64_t> ids;
  std::vector<double> measurement;
  auto operator<=>(const EdgeLine&) const = default;
};

template <typename E>
EdgeLine lineOf(const Edge& edge) {
  const auto ids = edge.vertexIds();
  const auto m = static_cast<const E&>(edge).measurement();
  EdgeLine line{{ids.begin(), ids.end()}, {}};
  for (const double number : m) line.measurement.push_back(number);
  return line;
}

/// Edges between `ids` (of so many each at random), some of them several times, in an order of their own.
template <typename E>
void expectSorted(const std::vector<std::int64_t>& ids, int leastArity, int mostArity, std::mt19937_64& random) {
  Graph graph(makeRegistry());
  for (const std::int64_t id : ids) graph.addVertex<VertexPoint>(id, Vector<double, 2>(1.0, 2.0));
  std::uniform_int_distribution<int> arity(leastArity, mostArity);
  std::uniform_int_distribution<int> value(-3, 3);
  std::vector<const Edge*> edges;
  std::vector<EdgeLine> expected;
  for (int i = 0; i < 200; ++i) {
    std::vector<std::int64_t> joined(ids);
    std::shuffle(joined.begin(), joined.end(), random);
    joined.resize(static_cast<std::size_t>(arity(random)));
    const Vector<double, 2> m(value(random), value(random));
    edges.push_back(&graph.addEdge<E>(std::span<const std::int64_t>(joined), m, Matrix<double, 2, 2>::Identity()));
    expected.push_back(lineOf<E>(*edges.back()));
  }
  std::sort(expected.begin(), expected.end());
  for (const bool shuffled : {true, false}) {  // then from sorted
    if (shuffled) std::shuffle(edges.begin(), edges.end(), random);
    sortEdges(graph, edges);
    for (std::size_t i = 0; i < edges.size(); ++i) ASSERT_EQ(lineOf<E>(*edges[i]), expected[i]) << i;
  }
}

TEST(CanonicalOrder, IsByIdsThenByMeasurement) {
  std::mt19937_64 random(3);
  const std::vector<std::int64_t> dense{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  const std::vector<std::int64_t> spread{0, 5, 1'000'000, 7'000'000'000'000, 9'223'372'036'854'775'806};
  for (const auto& ids : {dense, spread}) {
    expectSorted<EdgePoint>(ids, 1, 1, random);
    expectSorted<EdgeMean>(ids, 2, 2, random);
    expectSorted<EdgeMean>(ids, 1, 4, random);
  }
}

}  // namespace
}  // namespace quiver
