#include "projections.h"

#include <random>

#include <quiver/plugins/builtin.h>

namespace quiver::test {

Graph bundle(const BundleShape& shape) {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<VertexView>("CAMERA");
  registry->addVertex<VertexPlace>("POINT");
  registry->addVertex<VertexLens>("INTRINSICS");
  registry->addEdge<EdgePixel>("PIXEL");
  registry->addEdge<EdgeBetween>("BETWEEN");
  registry->addEdge<EdgeMotion>("MOTION");
  registerLinearSystems(*registry);
  Graph graph(registry);
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const auto noise = [&](double deviation) { return deviation * normal(random); };
  std::vector<Vector<double, 6>> views;
  const Vector<double, 2> lens(400.0, -0.05);
  for (int i = 0; i < shape.cameras; ++i) {
    Vector<double, 6> view(noise(0.05), noise(0.05), noise(0.05), -0.5 * i, noise(0.1), noise(0.1));
    views.push_back(view);
    Vector<double, 6> start = view;
    for (int k = 0; k < 6; ++k) start[k] += i == 0 ? 0.0 : noise(k < 3 ? 0.01 : 0.05);
    graph.addVertex<VertexView>(i, start).setFixed(i == 0);
    if (i == 0) continue;
    Vector<double, 6> motion = view - views[static_cast<std::size_t>(i - 1)];
    for (int k = 0; k < 6; ++k) motion[k] += noise(0.01);
    graph.addEdge<EdgeMotion>({i - 1, i}, motion, Matrix<double, 6, 6>(1e4 * Matrix<double, 6, 6>::Identity()));
  }
  graph.addVertex<VertexLens>(lensId, Vector<double, 2>(405.0, -0.04));
  std::vector<Vector<double, 3>> places;
  for (int p = 0; p < shape.points; ++p) {
    const double along = 0.5 * shape.cameras * p / shape.points;
    const Vector<double, 3> place(along + noise(0.5), noise(1.0), 5.0 + std::abs(noise(1.0)));
    const int nearest = std::clamp(static_cast<int>(along / 0.5), 0, shape.cameras - 1);
    Vector<double, 3> start = place;
    for (int k = 0; k < 3; ++k) start[k] += noise(0.05);
    graph.addVertex<VertexPlace>(firstPoint + p, start);
    const int most = p < shape.seenOnce ? 1 : 3 + p % 3;
    for (int k = 0; k < most; ++k) {
      const int i = (nearest + k) % shape.cameras;
      Vector<double, 2> pixel =
          EdgePixel::computeError<double>(Vector<double, 2>(0.0, 0.0), views[static_cast<std::size_t>(i)], place, lens);
      pixel += Vector<double, 2>(noise(0.5), noise(0.5));
      graph.addEdge<EdgePixel>({i, firstPoint + p, lensId}, pixel,
                               Matrix<double, 2, 2>(4.0 * Matrix<double, 2, 2>::Identity()));
    }
    places.push_back(place);
  }
  for (int j = 0; j < shape.joinedPoints; ++j) {
    const int p = 2 * j;
    const Vector<double, 3> between = places[static_cast<std::size_t>(p + 1)] - places[static_cast<std::size_t>(p)] +
                                      Vector<double, 3>(0.01, 0.0, -0.01);
    graph.addEdge<EdgeBetween>({firstPoint + p, firstPoint + p + 1}, between,
                               Matrix<double, 3, 3>(100.0 * Matrix<double, 3, 3>::Identity()));
  }
  return graph;
}

}  // namespace quiver::test
