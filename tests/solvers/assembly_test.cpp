#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/linear_system.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/problem/problem.h>
#include <quiver/quiver.h>
#include <Eigen/Core>

namespace quiver {
namespace {

/// What differs between the worlds that are assembled.
struct World {
  const char* name;
  bool fullInformation = false;
  bool doubledEdges = false;
  bool fixedVertex = false;
  bool heldDirection = false;
  bool robust = false;
  bool priors = false;
};

template <int N>
Matrix<double, N, N> information(std::mt19937_64& random, bool full) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Matrix<double, N, N> root = Matrix<double, N, N>::Zero();
  for (int r = 0; r < N; ++r) {
    for (int c = 0; c < N; ++c) root(r, c) = r == c ? 2.0 + uniform(random) : (full ? uniform(random) : 0.0);
  }
  return root.transpose() * root;
}

SE2<double> pose2(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  return SE2<double>(uniform(random), uniform(random), uniform(random));
}
SE3<double> pose3(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Vector<double, 6> tangent;
  for (int i = 0; i < 6; ++i) tangent[i] = 2.0 * uniform(random);
  return SE3<double>::exp(tangent);
}

/// A loop of 37 poses in the plane and one of 29 in space with chords, no multiple of the lanes' eight.
Graph makeWorld(const World& world) {
  Graph graph(builtinRegistry());
  std::mt19937_64 random(11);
  constexpr int planar = 37;
  constexpr int spatial = 29;
  for (int i = 0; i < planar; ++i) graph.addVertex<VertexSE2>(i, pose2(random));
  for (int i = 0; i < spatial; ++i) graph.addVertex<VertexSE3>(1000 + i, pose3(random));
  const auto join = [&](int step, int first) {
    for (int i = 0; i < planar; ++i) {
      graph.addEdge<EdgeSE2>({(i * first) % planar, (i * first + step) % planar}, pose2(random),
                             information<3>(random, world.fullInformation));
    }
    for (int i = 0; i < spatial; ++i) {
      graph.addEdge<EdgeSE3>({1000 + (i * first) % spatial, 1000 + (i * first + step) % spatial}, pose3(random),
                             information<6>(random, world.fullInformation));
    }
  };
  join(1, 1);
  join(5, 3);
  if (world.doubledEdges) join(5, 3);
  if (world.priors) {
    for (int i = 0; i < planar; i += 4)
      graph.addEdge<EdgePriorSE2>({i}, pose2(random), information<3>(random, world.fullInformation));
  }
  if (world.fixedVertex) {
    graph.vertex<VertexSE2>(3).setFixed(true);
    graph.vertex<VertexSE3>(1007).setFixed(true);
  }
  if (world.heldDirection) {
    graph.vertex<VertexSE2>(5).setFixedDirections(0b010);
    graph.vertex<VertexSE3>(1004).setFixedDirections(0b100001);
  }
  if (world.robust) {
    graph.forEachEdge([](Edge& edge) { edge.setRobustKernel(RobustKernelHuber(1.0)); });
  }
  return graph;
}

struct Dense {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  double chi2 = 0.0;
};

/// Σ JᵀJ and Σ Jᵀr edge by edge from panels of one edge.
Dense denseTwin(const Problem& problem) {
  Dense dense{Eigen::MatrixXd::Zero(problem.scalars(), problem.scalars()), Eigen::VectorXd::Zero(problem.scalars())};
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    PanelBuffer buffer(batch.largestShape());
    for (std::int32_t i = 0; i < batch.size(); ++i) {
      const Panel& panel = buffer.panel();
      batch.linearize(problem.state(), {&i, 1}, panel);
      const EdgeShape shape = batch.shape(i);
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(shape.rows, problem.scalars());
      Eigen::VectorXd r(shape.rows);
      for (int k = 0; k < shape.rows; ++k) r[k] = panel.residual[k * Panel::lanes];
      for (std::size_t role = 0; role < shape.columns.size(); ++role) {
        const int variable = problem.variableOfSlot(batch.slots(i)[role]);
        for (int c = 0; variable >= 0 && c < shape.columns[role]; ++c) {
          if (problem.heldDirections(variable) >> c & 1) continue;
          for (int k = 0; k < shape.rows; ++k)
            J(k, problem.offset(variable) + c) = panel.jacobian[role][(c * shape.rows + k) * Panel::lanes];
        }
      }
      dense.H += J.transpose() * J;
      dense.g += J.transpose() * r;
      dense.chi2 += panel.squaredError[0];
    }
  }
  for (int v = 0; v < problem.variables(); ++v) {
    for (int c = 0; c < problem.dimension(v); ++c) {
      if (problem.heldDirections(v) >> c & 1) dense.H(problem.offset(v) + c, problem.offset(v) + c) = 1.0;
    }
  }
  return dense;
}

class Assembly : public testing::TestWithParam<World> {};

TEST_P(Assembly, EqualsTheDenseSumOfProducts) {
  Graph graph = makeWorld(GetParam());
  std::vector<double> reference;
  for (const int threads : {1, 2, 3}) {
    const Problem problem(graph, {.level = 0, .free = {}, .threads = threads});
    const Dense dense = denseTwin(problem);
    const Options options;
    const auto system = (*graph.registry()->findLinearSystem("block"))(options);
    system->analyze(problem, options, threads);
    // The second linearisation finds memory in use.
    system->linearize(problem.state());
    const CostTotals totals = system->linearize(problem.state());
    EXPECT_NEAR(totals.chi2, dense.chi2, 1e-12 * dense.chi2);
    const auto n = static_cast<std::size_t>(problem.scalars());
    std::vector<double> unit(n, 0.0);
    std::vector<double> column(n);
    std::vector<double> numbers(system->gradient().begin(), system->gradient().end());
    // Sums of a few hundred products, added in another order, of numbers up to the largest of H.
    const double tolerance = 1e-13 * dense.H.cwiseAbs().maxCoeff();
    for (std::size_t c = 0; c < n; ++c) {
      unit[c] = 1.0;
      system->multiply(unit, column);
      unit[c] = 0.0;
      for (std::size_t r = 0; r < n; ++r)
        ASSERT_NEAR(column[r], dense.H(static_cast<int>(r), static_cast<int>(c)), tolerance) << r << ", " << c;
      ASSERT_NEAR(system->gradient()[c], dense.g[static_cast<int>(c)], 1e-13 * dense.g.cwiseAbs().maxCoeff());
      ASSERT_EQ(system->diagonal()[c], column[c]);
      numbers.insert(numbers.end(), column.begin(), column.end());
    }
    if (reference.empty()) reference = numbers;
    EXPECT_EQ(numbers, reference) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, Assembly,
    testing::Values(World{.name = "DiagonalInformation"}, World{.name = "FullInformation", .fullInformation = true},
                    World{.name = "DoubledEdges", .fullInformation = true, .doubledEdges = true},
                    World{.name = "FixedVertices", .doubledEdges = true, .fixedVertex = true},
                    World{.name = "HeldDirections", .fullInformation = true, .heldDirection = true},
                    World{.name = "RobustKernels", .fullInformation = true, .robust = true},
                    World{.name = "Priors", .fixedVertex = true, .priors = true}),
    [](const auto& info) { return std::string(info.param.name); });

/// One full information matrix among diagonal ones, and back: what is packed follows.
TEST(AssemblyRefresh, FollowsInformationThatStopsBeingDiagonal) {
  Graph graph = makeWorld({.name = ""});
  Problem problem(graph, {.level = 0, .free = {}, .threads = 1});
  const Options options;
  const auto system = (*graph.registry()->findLinearSystem("block"))(options);
  system->analyze(problem, options, 1);
  std::mt19937_64 random(5);
  for (const bool full : {true, false}) {
    int count = 0;
    graph.forEachEdge([&](Edge& edge) {
      if (edge.arity() == 2 && edge.vertexId(0) < 1000 && count++ == 20)
        static_cast<EdgeSE2&>(edge).setInformation(information<3>(random, full));
    });
    problem.refresh();
    const Dense dense = denseTwin(problem);
    const CostTotals totals = system->linearize(problem.state());
    EXPECT_NEAR(totals.chi2, dense.chi2, 1e-12 * dense.chi2);
    for (int i = 0; i < static_cast<int>(dense.g.size()); ++i)
      ASSERT_NEAR(system->gradient()[static_cast<std::size_t>(i)], dense.g[i], 1e-13 * dense.g.cwiseAbs().maxCoeff());
  }
}

}  // namespace
}  // namespace quiver
