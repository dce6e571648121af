#include <quiver/core/problem/whitening.h>

#include <array>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <quiver/core/problem/problem.h>
#include <Eigen/Cholesky>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using detail::Whitening;
using detail::whiteningOf;

TEST(Whitening, IsTheLeastGeneral) {
  EXPECT_EQ(whiteningOf(std::array{1.0}, 1), Whitening::none);
  EXPECT_EQ(whiteningOf(std::array{2.0}, 1), Whitening::diagonal);
  EXPECT_EQ(whiteningOf(std::array{1.0, 0.0, 1.0}, 2), Whitening::none);
  EXPECT_EQ(whiteningOf(std::array{1.0, -0.0, 1.0}, 2), Whitening::none);
  EXPECT_EQ(whiteningOf(std::array{1.0, 0.0, 0.0}, 2), Whitening::diagonal);
  EXPECT_EQ(whiteningOf(std::array{1.0, 1e-300, 1.0}, 2), Whitening::triangular);
  EXPECT_EQ(whiteningOf(std::array{1.0, 0.0, 0.0, 3.0, 0.0, 1.0}, 3), Whitening::diagonal);
  EXPECT_EQ(whiteningOf(std::array{1.0, 0.0, 0.0, 1.0, 0.5, 1.0}, 3), Whitening::triangular);
  EXPECT_EQ(whiteningOf(std::array{4.0, 0.0, 0.0, 9.0, 0.0, 25.0}, 3), Whitening::diagonal);
  EXPECT_EQ(whiteningOf(std::array{4.0, 0.0, 0.0, 9.0, 0.5, 25.0}, 3), Whitening::triangular);
  EXPECT_EQ(whiteningOf(std::array{1.0 + std::numeric_limits<double>::epsilon()}, 1), Whitening::diagonal);
}

TEST(Whitening, KeepsAsManyNumbersAsItNeeds) {
  for (const int rows : {1, 2, 3, 6}) {
    EXPECT_EQ(detail::whiteningNumbers(Whitening::none, rows), 0);
    EXPECT_EQ(detail::whiteningNumbers(Whitening::diagonal, rows), rows);
    EXPECT_EQ(detail::whiteningNumbers(Whitening::triangular, rows), rows * (rows + 1) / 2);
  }
}

using Information = Matrix<double, 3, 3>;

Information informationOf(Whitening whitening, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.5, 3.0);
  Information information = Information::Identity();
  if (whitening == Whitening::none) return information;
  for (int i = 0; i < 3; ++i) information(i, i) = uniform(random);
  if (whitening == Whitening::triangular) information(0, 1) = information(1, 0) = 0.2;
  return information;
}

/// Poses of a ring, all of the first whitening but for every fifth edge, which is of the second.
Graph mixedGraph(Whitening mostly, Whitening some) {
  Graph graph = ringGraph<EdgeRangeDualLanes>(70, 0);
  std::mt19937_64 random(7);
  int at = 0;
  graph.forEachEdge([&](Edge& edge) {
    static_cast<EdgeSE2&>(edge).setInformation(informationOf(at++ % 5 == 3 ? some : mostly, random));
  });
  return graph;
}

/// Compares what a batch whitens with U times what it gives for identities.
void expectWhitened(Graph weighed, std::span<const std::int32_t> list) {
  Graph plain(weighed);
  plain.forEachEdge([](Edge& edge) { static_cast<EdgeSE2&>(edge).setInformation(Information::Identity()); });
  const Problem problem(weighed, {});
  const Problem reference(plain, {});
  const EdgeBatch& batch = problem.batch(0);
  PanelBuffer whitened(batch.largestShape());
  PanelBuffer raw(batch.largestShape());
  PanelBuffer errors(batch.largestShape(), false);
  batch.linearize(problem.state(), list, whitened.panel());
  batch.evaluate(problem.state(), list, errors.panel());
  reference.batch(0).linearize(reference.state(), list, raw.panel());
  const auto column = [](const double* numbers, std::size_t i, int begin) {
    Eigen::Vector3d v;
    const std::size_t group = i / Panel::lanes * 3;
    for (int r = 0; r < 3; ++r)
      v[r] = numbers[(group + static_cast<std::size_t>(begin * 3 + r)) * Panel::lanes + i % Panel::lanes];
    return v;
  };
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto& edge = static_cast<const EdgeSE2&>(batch.edge(list[i]));
    const Eigen::Matrix3d U = Eigen::Matrix3d(edge.information()).llt().matrixU();
    const Eigen::Vector3d r = U * column(raw.panel().residual, i, 0);
    ASSERT_NEAR((column(whitened.panel().residual, i, 0) - r).norm(), 0.0, 1e-13);
    ASSERT_NEAR((column(errors.panel().residual, i, 0) - r).norm(), 0.0, 1e-13);
    ASSERT_NEAR(whitened.panel().squaredError[i], r.squaredNorm(), 1e-13);
    for (int role = 0; role < 2; ++role) {
      for (int c = 0; c < 3; ++c) {
        const std::size_t shifted = i / Panel::lanes * 3 * Panel::lanes + i % Panel::lanes;  // nine numbers a block
        const Eigen::Vector3d J = U * column(raw.panel().jacobian[role], shifted, c);
        ASSERT_NEAR((column(whitened.panel().jacobian[role], shifted, c) - J).norm(), 0.0, 1e-13) << i << ' ' << c;
      }
    }
  }
}

TEST(Whitening, MultipliesErrorsAndBlocks) {
  constexpr std::array all{Whitening::none, Whitening::diagonal, Whitening::triangular};
  std::vector<std::int32_t> run(64), part(13), scattered(61), later(24);
  std::iota(run.begin(), run.end(), 0);
  std::iota(part.begin(), part.end(), 56);
  std::iota(later.begin(), later.end(), 16);
  for (std::size_t i = 0; i < scattered.size(); ++i) scattered[i] = static_cast<std::int32_t>(i * 17 % 70);
  const std::vector<std::int32_t> last{69}, odd{3, 4, 5, 6, 7, 8, 9, 10};
  for (const Whitening mostly : all) {
    for (const Whitening some : all) {
      const Graph graph = mixedGraph(mostly, some);
      for (const auto& list : {run, part, scattered, later, last, odd}) expectWhitened(graph, list);
    }
  }
}

}  // namespace
}  // namespace quiver
