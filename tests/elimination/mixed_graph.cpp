#include "mixed_graph.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>
#include <quiver/plugins/builtin.h>

namespace quiver::test {
namespace {

using Edge93 = EdgeMix<true, 2, 9, 3>;
using Edge63 = EdgeMix<true, 2, 6, 3>;
using Edge36 = EdgeMix<false, 3, 3, 6>;
using Edge61 = EdgeMix<true, 2, 6, 1>;
using Edge32 = EdgeMix<true, 2, 3, 2>;
using Edge22 = EdgeMix<false, 2, 2, 2>;
using Edge11 = EdgeMix<false, 1, 1, 1>;
using Edge66 = EdgeMix<false, 6, 6, 6>;
using Edge91 = EdgeMix<false, 3, 9, 1>;
using Edge633 = EdgeMix<true, 2, 6, 3, 3>;
using Edge932 = EdgeMix<false, 2, 9, 3, 2>;
using Edge3216 = EdgeMix<false, 2, 3, 2, 1, 6>;
using Anchor1 = EdgeMix<true, 1, 1>;
using Anchor2 = EdgeMix<true, 2, 2>;
using Anchor3 = EdgeMix<true, 3, 3>;
using Anchor6 = EdgeMix<true, 6, 6>;
using Anchor9 = EdgeMix<true, 9, 9>;

/// Ids by dimension.
using Ids = std::vector<std::vector<std::int64_t>>;

template <typename Edge, int... D>
void addRandomEdge(Graph& graph, const Ids& ids, double scale, std::mt19937& random) {
  std::vector<std::int64_t> chosen;
  for (const int d : {D...}) {
    std::vector<std::int64_t> free;
    for (const std::int64_t id : ids[static_cast<std::size_t>(d)]) {
      if (std::find(chosen.begin(), chosen.end(), id) == chosen.end()) free.push_back(id);
    }
    if (free.empty()) return;
    chosen.push_back(free[random() % free.size()]);
  }
  std::normal_distribution<double> normal;
  typename Edge::Measurement m;
  for (int i = 0; i < m.size(); ++i) m[i] = scale * normal(random);
  constexpr int n = Edge::errorDimension;
  const Matrix<double, n, n> root = Matrix<double, n, n>::NullaryExpr([&] { return 0.3 * normal(random); });
  graph.addEdge<Edge>(chosen, m, Matrix<double, n, n>(root * root.transpose() + Matrix<double, n, n>::Identity()));
}

template <int D>
void addVertexAndAnchor(Graph& graph, std::int64_t id, bool anchored, std::mt19937& random) {
  std::normal_distribution<double> normal;
  graph.addVertex<VertexOf<D>>(id, Vector<double, D>::NullaryExpr([&] { return 0.3 * normal(random); }));
  if (!anchored) return;
  Vector<double, D*(D + 1)> m = Vector<double, D*(D + 1)>::Zero();
  for (int i = 0; i < D; ++i) m[i * (D + 1)] = 1.0;
  for (int i = 0; i < D; ++i) m[D * D + i] = normal(random);
  graph.addEdge<EdgeMix<true, D, D>>({id}, m, Matrix<double, D, D>::Identity());
}

void addSum(Graph& graph, const Ids& ids, std::mt19937& random) {
  std::vector<std::int64_t> chosen = ids[3];
  std::shuffle(chosen.begin(), chosen.end(), random);
  chosen.resize(std::min<std::size_t>(chosen.size(), 1 + random() % 4));
  if (chosen.empty()) return;
  std::normal_distribution<double> normal;
  graph.addEdge<EdgeSum>(chosen, Vector<double, 4>::NullaryExpr([&] { return normal(random); }),
                         Matrix<double, 3, 3>::Identity());
}

}  // namespace

std::shared_ptr<Registry> mixedRegistry() {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<VertexOf<1>>("V1");
  registry->addVertex<VertexOf<2>>("V2");
  registry->addVertex<VertexOf<3>>("V3");
  registry->addVertex<VertexOf<6>>("V6");
  registry->addVertex<VertexOf<9>>("V9");
  registry->addEdge<Edge93>("E93");
  registry->addEdge<Edge63>("E63");
  registry->addEdge<Edge36>("E36");
  registry->addEdge<Edge61>("E61");
  registry->addEdge<Edge32>("E32");
  registry->addEdge<Edge22>("E22");
  registry->addEdge<Edge11>("E11");
  registry->addEdge<Edge66>("E66");
  registry->addEdge<Edge91>("E91");
  registry->addEdge<Edge633>("E633");
  registry->addEdge<Edge932>("E932");
  registry->addEdge<Edge3216>("E3216");
  registry->addEdge<Anchor1>("A1");
  registry->addEdge<Anchor2>("A2");
  registry->addEdge<Anchor3>("A3");
  registry->addEdge<Anchor6>("A6");
  registry->addEdge<Anchor9>("A9");
  registry->addEdge<EdgeSum>("SUM");
  registerLinearSystems(*registry);
  return registry;
}

Graph randomMixedGraph(const MixedShape& shape, std::mt19937& random) {
  static const auto registry = mixedRegistry();
  Graph graph(registry);
  Ids ids(10);
  for (std::int64_t id = 0; id < shape.vertices; ++id) {
    constexpr int dimensions[] = {1, 2, 3, 6, 9};
    const int d = dimensions[random() % 5];
    ids[static_cast<std::size_t>(d)].push_back(id);
    if (d == 1) addVertexAndAnchor<1>(graph, id, shape.anchored, random);
    if (d == 2) addVertexAndAnchor<2>(graph, id, shape.anchored, random);
    if (d == 3) addVertexAndAnchor<3>(graph, id, shape.anchored, random);
    if (d == 6) addVertexAndAnchor<6>(graph, id, shape.anchored, random);
    if (d == 9) addVertexAndAnchor<9>(graph, id, shape.anchored, random);
    const double draw = static_cast<double>(random() % 1000) / 1000.0;
    if (draw < shape.fixed) {
      graph.findVertex(id)->setFixed(true);
    } else if (draw < shape.fixed + shape.held) {
      graph.findVertex(id)->setFixedDirections(random() % (std::uint64_t{1} << d));
    }
  }
  for (int i = 0; i < shape.edges; ++i) {
    switch (random() % 13) {
      case 0:
        addRandomEdge<Edge93, 9, 3>(graph, ids, 1.0, random);
        break;
      case 1:
        addRandomEdge<Edge63, 6, 3>(graph, ids, 1.0, random);
        break;
      case 2:
        addRandomEdge<Edge36, 3, 6>(graph, ids, 1.0, random);
        break;
      case 3:
        addRandomEdge<Edge61, 6, 1>(graph, ids, 1.0, random);
        break;
      case 4:
        addRandomEdge<Edge32, 3, 2>(graph, ids, 1.0, random);
        break;
      case 5:
        addRandomEdge<Edge22, 2, 2>(graph, ids, 1.0, random);
        break;
      case 6:
        addRandomEdge<Edge11, 1, 1>(graph, ids, 1.0, random);
        break;
      case 7:
        addRandomEdge<Edge66, 6, 6>(graph, ids, 1.0, random);
        break;
      case 8:
        addRandomEdge<Edge91, 9, 1>(graph, ids, 1.0, random);
        break;
      case 9:
        addRandomEdge<Edge633, 6, 3, 3>(graph, ids, 1.0, random);
        break;
      case 10:
        addRandomEdge<Edge932, 9, 3, 2>(graph, ids, 1.0, random);
        break;
      case 11:
        addRandomEdge<Edge3216, 3, 2, 1, 6>(graph, ids, 1.0, random);
        break;
      default:
        addSum(graph, ids, random);
        break;
    }
  }
  return graph;
}

DenseSystem::DenseSystem(const Problem& problem)
    : H(Eigen::MatrixXd::Zero(problem.scalars(), problem.scalars())), g(Eigen::VectorXd::Zero(problem.scalars())) {
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
        if (variable < 0) continue;
        for (int c = 0; c < shape.columns[role]; ++c) {
          if (problem.heldDirections(variable) >> c & 1) continue;
          for (int k = 0; k < shape.rows; ++k)
            J(k, problem.offset(variable) + c) = panel.jacobian[role][(c * shape.rows + k) * Panel::lanes];
        }
      }
      H += J.transpose() * J;
      g += J.transpose() * r;
    }
  }
  for (int v = 0; v < problem.variables(); ++v) {
    for (int c = 0; c < problem.dimension(v); ++c) {
      if (problem.heldDirections(v) >> c & 1) H(problem.offset(v) + c, problem.offset(v) + c) = 1.0;
    }
  }
}

std::vector<char> randomIndependentSet(const Problem& problem, std::mt19937& random) {
  std::vector<std::set<int>> neighbours(static_cast<std::size_t>(problem.variables()));
  for (int b = 0; b < problem.batches(); ++b) {
    for (int i = 0; i < problem.batch(b).size(); ++i) {
      for (const std::int32_t first : problem.batch(b).slots(i)) {
        for (const std::int32_t second : problem.batch(b).slots(i)) {
          const int u = problem.variableOfSlot(first);
          const int v = problem.variableOfSlot(second);
          if (u >= 0 && v >= 0 && u != v) neighbours[static_cast<std::size_t>(u)].insert(v);
        }
      }
    }
  }
  std::vector<int> order(neighbours.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<char> chosen(order.size(), 0);
  const double share = static_cast<double>(random() % 5) / 4.0;
  for (const int v : order) {
    const auto& own = neighbours[static_cast<std::size_t>(v)];
    const bool free =
        std::none_of(own.begin(), own.end(), [&](int u) { return chosen[static_cast<std::size_t>(u)] != 0; });
    if (free && static_cast<double>(random() % 1000) < 1000.0 * share) chosen[static_cast<std::size_t>(v)] = 1;
  }
  return chosen;
}

}  // namespace quiver::test
