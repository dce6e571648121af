// Bundles of cameras with a scale of their own: scaling a camera about its centre moves no pixel, so what its Jacobian
// has there is rounding.
#include <random>

#include <gtest/gtest.h>
#include <quiver/quiver.h>
#include <quiver/types_sba/sim3/edge_sim3.h>

namespace quiver {
namespace {

/// Cameras and points with exact pixels, then moved away from the truth.
Graph similarityBundle(int cameras, int points) {
  std::mt19937 random(3);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Graph graph(builtinRegistry());
  for (int i = 0; i < points; ++i)
    graph.addVertex<VertexXYZ>(1000 + i, Vector<double, 3>(uniform(-2, 2), uniform(-2, 2), uniform(4, 7)));
  const auto moved = [&](double size) {
    return Vector<double, 7>(Vector<double, 7>::NullaryExpr([&] { return size * uniform(-1, 1); }));
  };
  for (int c = 0; c < cameras; ++c) {
    CameraSimilarity<double> camera;
    const double intrinsics[] = {300.0, 310.0, 100.0, 120.0, 200.0, 210.0, 60.0, 70.0};
    std::copy_n(intrinsics, 8, camera.intrinsics);
    camera = VertexSim3Expmap::oplus(camera, moved(0.3));
    auto& vertex = graph.addVertex<VertexSim3Expmap>(c, camera);
    for (int i = 0; i < points; ++i) {
      const Vector<double, 3> point = graph.vertex<VertexXYZ>(1000 + i).estimate();
      const Vector<double, 2> pixel = -EdgeProjectSim3::computeError(Vector<double, 2>(0.0, 0.0), point, camera);
      graph.addEdge<EdgeProjectSim3>({1000 + i, c}, pixel, Matrix<double, 2, 2>::Identity());
    }
    vertex.setEstimate(VertexSim3Expmap::oplus(camera, moved(0.02)));
  }
  for (int i = 0; i < points; ++i) {
    auto& vertex = graph.vertex<VertexXYZ>(1000 + i);
    const Vector<double, 3> away = Vector<double, 3>::NullaryExpr([&] { return uniform(-0.1, 0.1); });
    vertex.setEstimate(Vector<double, 3>(vertex.estimate() + away));
  }
  return graph;
}

TEST(SimilarityBundle, ConvergesThoughScalesAreFree) {
  for (const auto& [cameras, points] : {std::pair{2, 8}, {5, 20}, {9, 40}}) {
    for (const bool eliminates : {true, false}) {
      for (const std::string solver : {"block", "dense"}) {
        Graph graph = similarityBundle(cameras, points);
        Options options;
        if (!eliminates) options.elimination = EliminationPolicy::none;
        options.linearSolver = solver;
        const Summary summary = optimize(graph, options);
        EXPECT_EQ(summary.status, Status::converged) << summary.reason;
        EXPECT_GT(summary.initialChi2, 100.0);
        EXPECT_LT(summary.finalChi2, 1e-12) << cameras << " " << eliminates << " " << solver;
      }
    }
  }
}

}  // namespace
}  // namespace quiver
