// Linearising and assembling: quiver's batches on one thread against a loop over heap objects with virtual calls, and
// EDGE_SE3:QUAT as a user would write it against the built-in one. Both sides must find the same chi2 and gradient.
//   quiver_bench_linearization [--json FILE] [--rounds N] [GRAPH.g2o...]
#include <map>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/core/problem/problem.h>
#include <quiver/quiver.h>

#include "peers/heap_graph.h"
#include "peers/measure.h"

using namespace quiver;

namespace {

/// EDGE_SE3:QUAT written with what geometry offers, its Jacobians by dual numbers.
class EdgeUserSE3 : public BaseEdge<EdgeUserSE3, 6, SE3<double>, VertexSE3, VertexSE3> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to) {
    const SE3<S> off = z.inverse() * (from.inverse() * to);
    const SO3<S>& q = off.rotation();
    const S sign = select(q.w() < S(0.0), S(-1.0), S(1.0));
    const Vector<S, 3> t = off.translation();
    Vector<S, 6> error;
    error << t[0], t[1], t[2], sign * q.x(), sign * q.y(), sign * q.z();
    return error;
  }
};

/// The same with Jacobians by hand, in plain matrices.
class EdgeUserAnalyticSE3 : public BaseEdge<EdgeUserAnalyticSE3, 6, SE3<double>, VertexSE3, VertexSE3> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to) {
    return EdgeUserSE3::computeError(z, from, to);
  }
  template <typename S>
  static void linearizeOplus(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to, Matrix<S, 6, 6>& J0,
                             Matrix<S, 6, 6>& J1) {
    const SE3<S> relative = from.inverse() * to;
    const SE3<S> off = z.inverse() * relative;
    const SO3<S>& q = off.rotation();
    const S half = select(q.w() < S(0.0), S(-0.5), S(0.5));
    const Matrix<S, 3, 3> R = z.rotation().inverse().matrix();
    const Matrix<S, 3, 3> v = hat<S>(Vector<S, 3>(half * q.x(), half * q.y(), half * q.z()));
    const Matrix<S, 3, 3> w = (half * q.w()) * Matrix<S, 3, 3>::Identity();
    J0.setZero();
    J1.setZero();
    J0.template block<3, 3>(0, 0) = -R;
    J0.template block<3, 3>(0, 3) = R * hat<S>(relative.translation());
    J0.template block<3, 3>(3, 3) = (v - w) * R;
    J1.template block<3, 3>(0, 0) = off.rotation().matrix();
    J1.template block<3, 3>(3, 3) = w + v;
  }
};

template <typename E>
Graph withUserEdges(const Graph& graph) {
  Graph result(graph.registry());
  graph.forEachVertex([&](const Vertex& vertex) {
    result.addVertex<VertexSE3>(vertex.id(), static_cast<const VertexSE3&>(vertex).estimate());
  });
  graph.forEachEdge([&](const Edge& edge) {
    const auto& typed = static_cast<const EdgeSE3&>(edge);
    result.addEdge<E>(edge.vertexIds(), typed.measurement(), typed.information());
  });
  return result;
}

bench::HeapGraph heapTwin(const Graph& graph, bool space) {
  bench::HeapGraph heap;
  std::map<std::int64_t, bench::HeapVertex*> vertices;
  graph.forEachVertex([&](const Vertex& vertex) {
    bench::HeapVertex& twin = heap.addVertex(space ? 6 : 3);
    vertices[vertex.id()] = &twin;
    if (space) {
      const SE3<double> x = static_cast<const VertexSE3&>(vertex).estimate();
      twin.pose.linear() = x.rotation().matrix();
      twin.pose.translation() = x.translation();
    } else {
      twin.planar = static_cast<const VertexSE2&>(vertex).estimate().toVector();
    }
  });
  graph.forEachEdge([&](const Edge& edge) {
    bench::HeapVertex& from = *vertices.at(edge.vertexId(0));
    bench::HeapVertex& to = *vertices.at(edge.vertexId(1));
    if (space) {
      const auto& typed = static_cast<const EdgeSE3&>(edge);
      Eigen::Isometry3d z = Eigen::Isometry3d::Identity();
      z.linear() = typed.measurement().rotation().matrix();
      z.translation() = typed.measurement().translation();
      heap.addSpatialEdge(from, to, z, typed.information());
    } else {
      const auto& typed = static_cast<const EdgeSE2&>(edge);
      heap.addPlanarEdge(from, to, typed.measurement().toVector(), typed.information());
    }
  });
  return heap;
}

/// A compiled graph whose linearisation can be repeated.
class Linearization {
 public:
  explicit Linearization(Graph graph)
      : graph_(std::move(graph)), problem_(graph_, {.level = -1, .free = {}, .threads = 1}) {
    const Options options;
    system_ = (*graph_.registry()->findLinearSystem("block"))(options);
    system_->analyze(problem_, options, 1);
  }
  double run() { return totals_ = system_->linearize(problem_.state()).chi2; }
  double chi2() const { return totals_; }
  double gradientSquare() const {
    double sum = 0.0;
    for (const double value : system_->gradient()) sum += value * value;
    return sum;
  }

 private:
  Graph graph_;
  Problem problem_;
  std::unique_ptr<LinearSystem> system_;
  double totals_ = 0.0;
};

constexpr int repetitions = 20;

template <typename Work>
double repeated(Work&& work) {
  return bench::secondsOf([&] {
           for (int i = 0; i < repetitions; ++i) work();
         }) /
         repetitions;
}

bool agree(double a, double b) { return std::abs(a - b) <= 1e-8 * std::abs(a); }

void report(bench::JsonRows& json, const std::string& name, double edges, const bench::Pair& pair, bool same) {
  fmt::print("{:<34} {:>10.1f} {:>10.1f} {:>7.2f}x{}\n", name, 1e9 * pair.ours / edges, 1e9 * pair.theirs / edges,
             pair.ratio, same ? "" : "  RESULTS DIFFER");
  json.begin(name);
  json.add("nanoseconds_per_edge", 1e9 * pair.ours / edges);
  json.add("peer_nanoseconds_per_edge", 1e9 * pair.theirs / edges);
  json.add("ratio", pair.ratio);
  json.add("same_result", same ? 1.0 : 0.0);
}

void compareUserEdge(bench::JsonRows& json, const std::string& name, int rounds, Linearization& builtin, Graph user,
                     double edges) {
  Linearization theirs(std::move(user));
  const bench::Pair pair = bench::comparePairs(
      rounds, [&] { return repeated([&] { builtin.run(); }); }, [&] { return repeated([&] { theirs.run(); }); });
  report(json, name, edges, pair,
         agree(builtin.chi2(), theirs.chi2()) && agree(builtin.gradientSquare(), theirs.gradientSquare()));
}

}  // namespace

int main(int count, char** words) {
  const bench::Arguments arguments(count, words, {"M3500", "torus3D", "sphere_noisy"});
  const auto registry = builtinRegistry();
  registry->addEdge<EdgeUserSE3>("EDGE_USER_SE3");
  registry->addEdge<EdgeUserAnalyticSE3>("EDGE_USER_ANALYTIC_SE3");
  bench::JsonRows json;
  fmt::print("{:<34} {:>10} {:>10} {:>8}\n", "one thread, ns an edge", "quiver", "peer", "ratio");
  for (const std::string& file : arguments.graphs) {
    const Graph graph = readGraph(file, registry);
    const bool space =
        std::as_const(graph).registry()->findVertexType("VERTEX_SE3:QUAT")->index() == graph.findVertex(0)->type();
    const std::string name = std::filesystem::path(file).stem().string();
    const auto edges = static_cast<double>(graph.edgeCount());
    Linearization ours(graph);
    bench::HeapGraph heap = heapTwin(graph, space);
    double chi2 = 0.0;
    const bench::Pair pair = bench::comparePairs(
        arguments.rounds, [&] { return repeated([&] { ours.run(); }); },
        [&] { return repeated([&] { chi2 = heap.linearize(); }); });
    report(json, name + " heap objects", edges, pair,
           agree(ours.chi2(), chi2) && agree(ours.gradientSquare(), heap.gradientSquare()));
    if (!space) continue;
    compareUserEdge(json, name + " user's, analytic", arguments.rounds, ours, withUserEdges<EdgeUserAnalyticSE3>(graph),
                    edges);
    compareUserEdge(json, name + " user's, dual numbers", arguments.rounds, ours, withUserEdges<EdgeUserSE3>(graph),
                    edges);
  }
  json.write(arguments.json);
}
