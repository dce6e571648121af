#include <quiver/initialization/pose_graph.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <quiver/core/problem/canonical_order.h>
#include <quiver/geometry/packing.h>

namespace quiver {
namespace {

template <int D>
struct PoseOf;
template <>
struct PoseOf<2> {
  using Pose = SE2<double>;
  static constexpr PoseKind kind = PoseKind::plane;
  static Pose probe() { return Pose(0.7, -0.4, 1.1); }
  static Matrix<double, 2, 2> rotation(const Pose& x) { return x.rotation().matrix(); }
  static Pose pose(const Matrix<double, 2, 2>& R, const Vector<double, 2>& t) {
    return Pose(t[0], t[1], std::atan2(R(1, 0), R(0, 0)));
  }
};
template <>
struct PoseOf<3> {
  using Pose = SE3<double>;
  static constexpr PoseKind kind = PoseKind::space;
  static Pose probe() { return Pose(SO3<double>(0.1, -0.3, 0.4, std::sqrt(0.74)), Vector<double, 3>(0.7, -0.4, 0.2)); }
  static Matrix<double, 3, 3> rotation(const Pose& x) { return x.rotation().matrix(); }
  static Pose pose(const Matrix<double, 3, 3>& R, const Vector<double, 3>& t) {
    const Eigen::Quaterniond q(R);
    return Pose(SO3<double>(q.x(), q.y(), q.z(), q.w()), t);
  }
};

/// Puts the estimates of the two poses of an edge back when it goes.
template <int D>
class PosesGuard {
  static constexpr int size = Packing<typename PoseOf<D>::Pose>::size;

 public:
  PosesGuard(const Graph& graph, std::array<Vertex*, 2> vertices) : graph_(graph), vertices_(vertices) {
    for (std::size_t i = 0; i < 2; ++i) {
      std::copy_n(graph.typeOf(*vertices_[i]).values(*vertices_[i]), size, saved_[i].begin());
      had_[i] = vertices_[i]->hasEstimate();
    }
  }
  PosesGuard(const PosesGuard&) = delete;
  PosesGuard& operator=(const PosesGuard&) = delete;
  ~PosesGuard() {
    for (std::size_t i = 0; i < 2; ++i) {
      graph_.typeOf(*vertices_[i]).setValues(*vertices_[i], saved_[i].data());
      vertices_[i]->setHasEstimate(had_[i]);
    }
  }

 private:
  const Graph& graph_;
  std::array<Vertex*, 2> vertices_;
  std::array<std::array<double, static_cast<std::size_t>(size)>, 2> saved_;
  std::array<bool, 2> had_;
};

/// The pose an edge gives its second vertex when the first is at `from`; false if it gives none. Leaves both estimates
/// as they were.
template <int D>
bool propagate(const EdgeType& type, const Edge& edge, Graph& graph, const typename PoseOf<D>::Pose& from,
               typename PoseOf<D>::Pose& to) {
  using Pose = typename PoseOf<D>::Pose;
  const std::array<Vertex*, 2> vertices = {graph.findVertex(edge.vertexId(0)), graph.findVertex(edge.vertexId(1))};
  const PosesGuard<D> guard(graph, vertices);
  std::array<double, static_cast<std::size_t>(Packing<Pose>::size)> values;
  Packing<Pose>::store(from, values.data());
  graph.typeOf(*vertices[0]).setValues(*vertices[0], values.data());
  const bool told = type.initialEstimate(edge, graph, 1, 1);
  if (told) to = Packing<Pose>::template load<double>(graph.typeOf(*vertices[1]).values(*vertices[1]));
  return told;
}

/// Whether edges of the type say X_to = X_from · Z: propagation from another pose gives the same Z.
template <int D>
bool isRelative(const EdgeType& type, const Edge& edge, Graph& graph) {
  using Pose = typename PoseOf<D>::Pose;
  const Pose probe = PoseOf<D>::probe();
  Pose fromOrigin, fromProbe;
  if (!propagate<D>(type, edge, graph, Pose(), fromOrigin) || !propagate<D>(type, edge, graph, probe, fromProbe))
    return false;
  const Pose expected = probe * fromOrigin;
  const double scale = 1.0 + fromOrigin.translation().norm();
  return (PoseOf<D>::rotation(expected) - PoseOf<D>::rotation(fromProbe)).norm() < 1e-9 &&
         (expected.translation() - fromProbe.translation()).norm() < 1e-9 * scale;
}

/// 1 / mean variance of a diagonal block of Ω⁻¹; singular information counts as very weak. `triangle` is the upper
/// triangle of Ω row by row, translation first.
template <int D>
void weigh(std::span<const double> triangle, double& rotationWeight, double& translationWeight) {
  constexpr int rows = D == 2 ? 3 : 6;
  Matrix<double, rows, rows> omega;
  bool diagonal = true;
  for (int r = 0, k = 0; r < rows; ++r) {
    for (int c = r; c < rows; ++c, ++k) {
      omega(r, c) = omega(c, r) = triangle[static_cast<std::size_t>(k)];
      diagonal = diagonal && (r == c || omega(r, c) == 0.0);
    }
  }
  const double floor = std::max(1e-9 * omega.diagonal().maxCoeff(), 1e-12);
  omega.diagonal().array() += floor;
  Vector<double, rows> variance;
  if (diagonal) {
    variance = omega.diagonal().cwiseInverse();
  } else {
    variance = omega.partialPivLu().solve(Matrix<double, rows, rows>::Identity()).diagonal();
  }
  translationWeight = D / variance.template head<D>().sum();
  rotationWeight = (rows - D) / variance.template tail<rows - D>().sum();
}

template <int D>
void numberComponents(PoseGraph<D>& poses) {
  std::vector<int> parent(poses.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto find = [&](int i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      parent[static_cast<std::size_t>(i)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
      i = parent[static_cast<std::size_t>(i)];
    }
    return i;
  };
  for (const auto& edge : poses.edges) {
    const int a = find(edge.from);
    const int b = find(edge.to);
    parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  poses.component.assign(poses.vertices.size(), -1);
  std::vector<int> anchored;
  for (int i = 0; i < static_cast<int>(poses.vertices.size()); ++i) {
    const auto root = static_cast<std::size_t>(find(i));
    if (root == static_cast<std::size_t>(i)) {
      poses.component[root] = poses.components++;
      anchored.push_back(0);
    }
    poses.component[static_cast<std::size_t>(i)] = poses.component[root];
    if (poses.held[static_cast<std::size_t>(i)]) anchored[static_cast<std::size_t>(poses.component[root])] = 1;
  }
  // An origin of its own choice would turn and shift what the other estimates say.
  for (const bool missing : {false, true}) {
    for (std::size_t i = 0; i < poses.vertices.size(); ++i) {
      int& anchor = anchored[static_cast<std::size_t>(poses.component[i])];
      if (!anchor && (missing || poses.vertices[i]->hasEstimate())) poses.held[i] = static_cast<char>(anchor = 1);
    }
  }
}

}  // namespace

bool hasRelativePoses(const Graph& graph, const Options& options) {
  const Registry& registry = *graph.registry();
  std::vector<char> relative;
  for (const auto& type : registry.edgeTypes()) {
    const VertexType* first = registry.findVertexTypeByName(type->vertexTypeName(0));
    const VertexType* second = registry.findVertexTypeByName(type->vertexTypeName(1));
    relative.push_back(type->arity() == 2 && first && second && first->poseKind() != PoseKind::none &&
                       first->poseKind() == second->poseKind());
  }
  bool found = false;
  graph.forEachEdge([&](const Edge& edge) {
    found = found || (relative[static_cast<std::size_t>(edge.type())] != 0 &&
                      (options.level < 0 || edge.level() == options.level));
  });
  return found;
}

template <int D>
PoseGraph<D> readPoseGraph(Graph& graph, const Options& options) {
  using Pose = typename PoseOf<D>::Pose;
  PoseGraph<D> poses;
  graph.forEachVertex([&](Vertex& vertex) {
    if (graph.typeOf(vertex).poseKind() == PoseOf<D>::kind) poses.vertices.push_back(&vertex);
  });
  sortVertices(graph, poses.vertices);
  std::vector<std::int64_t> free = options.free;
  std::sort(free.begin(), free.end());
  IdMap index;
  for (std::size_t i = 0; i < poses.vertices.size(); ++i) {
    Vertex& vertex = *poses.vertices[i];
    index.insert(vertex.id(), {0, static_cast<std::int32_t>(i)});
    const bool moves = free.empty() || std::binary_search(free.begin(), free.end(), vertex.id());
    poses.held.push_back((vertex.fixedDirections() != 0 || !moves) && vertex.hasEstimate());
    const Pose x =
        vertex.hasEstimate() ? Packing<Pose>::template load<double>(graph.typeOf(vertex).values(vertex)) : Pose();
    poses.rotations.push_back(PoseOf<D>::rotation(x));
    poses.translations.push_back(x.translation());
  }

  std::vector<const Edge*> edges;
  std::map<int, bool> relative;  // by edge type, asked once
  std::as_const(graph).forEachEdge([&](const Edge& edge) {
    if (edge.arity() != 2 || (options.level >= 0 && edge.level() != options.level)) return;
    if (!index.find(edge.vertexId(0)).valid() || !index.find(edge.vertexId(1)).valid()) return;
    const auto [known, isNew] = relative.emplace(edge.type(), false);
    if (isNew) known->second = isRelative<D>(graph.typeOf(edge), edge, graph);
    if (known->second) edges.push_back(&edge);
  });
  for (const int type : edgeTypeOrder(*graph.registry())) {
    std::vector<const Edge*> ofType;
    std::copy_if(edges.begin(), edges.end(), std::back_inserter(ofType),
                 [type](const Edge* edge) { return edge->type() == type; });
    sortEdges(graph, ofType);
    for (const Edge* edge : ofType) {
      const EdgeType& edgeType = graph.typeOf(*edge);
      Pose z;
      propagate<D>(edgeType, *edge, graph, Pose(), z);
      typename PoseGraph<D>::Relative one{index.find(edge->vertexId(0)).slot,
                                          index.find(edge->vertexId(1)).slot,
                                          PoseOf<D>::rotation(z),
                                          z.translation(),
                                          1.0,
                                          1.0};
      if (edgeType.errorDimension(*edge) == (D == 2 ? 3 : 6)) {
        weigh<D>(edgeType.information(*edge), one.rotationWeight, one.translationWeight);
      }
      poses.edges.push_back(one);
    }
  }
  numberComponents(poses);
  return poses;
}

template <int D>
void writePoses(const PoseGraph<D>& poses, Graph& graph) {
  using Pose = typename PoseOf<D>::Pose;
  for (std::size_t i = 0; i < poses.vertices.size(); ++i) {
    Vertex& vertex = *poses.vertices[i];
    if (poses.held[i] && vertex.hasEstimate()) continue;
    std::array<double, Packing<Pose>::size> values;
    Packing<Pose>::store(PoseOf<D>::pose(poses.rotations[i], poses.translations[i]), values.data());
    graph.typeOf(vertex).setValues(vertex, values.data());
  }
}

template PoseGraph<2> readPoseGraph<2>(Graph&, const Options&);
template PoseGraph<3> readPoseGraph<3>(Graph&, const Options&);
template void writePoses<2>(const PoseGraph<2>&, Graph&);
template void writePoses<3>(const PoseGraph<3>&, Graph&);

}  // namespace quiver
