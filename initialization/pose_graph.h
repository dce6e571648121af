#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>
#include <quiver/geometry/linear.h>

namespace quiver {

/// The relative poses of a graph, stripped of types: what linear initial guesses work on. `D` is 2 or 3.
template <int D>
struct PoseGraph {
  using Rotation = Matrix<double, D, D>;
  using Translation = Vector<double, D>;

  struct Relative {
    int from;
    int to;
    /// X_to ≈ X_from · (rotation, translation).
    Rotation rotation;
    Translation translation;
    /// Isotropic weights: 1 / the mean variance of the rotation's angles and of the translation.
    double rotationWeight;
    double translationWeight;
  };

  /// Pose vertices in canonical order.
  std::vector<Vertex*> vertices;
  std::vector<char> held;
  std::vector<Rotation> rotations;
  std::vector<Translation> translations;
  std::vector<Relative> edges;
  /// The component of each pose, numbered by its first pose.
  std::vector<int> component;
  int components = 0;
};

/// Whether readPoseGraph could find a relative pose in the plane or in space, judged by the types of edges and vertices
/// alone. O(edges).
bool hasRelativePoses(const Graph& graph, const Options& options);

/// Reads every binary edge between two poses of kind D whose type can propagate a pose and does so as X_to = X_from ·
/// Z, whatever Z depends on. Edges of `options.level` take part. Fixed vertices are held, and in each component without
/// any the first pose that has an estimate is, or the first of all.
template <int D>
PoseGraph<D> readPoseGraph(Graph& graph, const Options& options);

extern template PoseGraph<2> readPoseGraph<2>(Graph&, const Options&);
extern template PoseGraph<3> readPoseGraph<3>(Graph&, const Options&);

/// Writes the poses that are not held into the graph.
template <int D>
void writePoses(const PoseGraph<D>& poses, Graph& graph);

extern template void writePoses<2>(const PoseGraph<2>&, Graph&);
extern template void writePoses<3>(const PoseGraph<3>&, Graph&);

}  // namespace quiver
