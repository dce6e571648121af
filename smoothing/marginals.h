#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/algorithm/summary.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// Covariances of the estimates of a graph: blocks of H⁻¹, H = Σ JᵀJ whitened by information and robust kernels, at the
/// estimates that the graph has now. Call it where a descent has converged; elsewhere H says little.
///
/// A block is in the tangent of its vertices, in the order and units of VertexType::tangentNames (poses: metres, then
/// radians, in the body frame). Information matrices are taken at their word: no factor is estimated from residuals.
/// Along directions that are fixed, and along those by which the gauge is held, covariances are zero: what remains is
/// relative to them. In a component in which vertices are fixed nothing else is held, unless GaugePolicy::fix asks for
/// it: what those leave free is undetermined. Landmarks and poses alike are had in any combination, whatever solver
/// made the estimates.
///
/// A snapshot: later changes of the graph do not reach it.
class Marginals {
 public:
  /// Of `options` counts what defines the problem: level, free, robustCorrection, threads, and gauge, where automatic
  /// holds components without fixed vertices; and what may end the work early, after which there are no covariances:
  /// memoryLimit, timeLimit, stopToken. Throws GraphError as `optimize` does for a graph that cannot be compiled. About
  /// three factorisations of all variables at once, on one thread, and twice the memory of the factor. The graph is not
  /// changed.
  explicit Marginals(Graph& graph, const Options& options = {});
  ~Marginals();
  Marginals(Marginals&&) noexcept;
  Marginals& operator=(Marginals&&) noexcept;

  /// Whether some vertex has a covariance, or there is none to have one; otherwise `reason` names a vertex and the
  /// directions that nothing constrains, or an error that is not finite.
  bool ok() const;
  const std::string& reason() const;
  /// Whether timeLimit or stopToken ended the work.
  bool stopped() const;
  /// What was held so that H has an inverse.
  const GaugeReport& gauge() const;
  /// Vertices that have a covariance, ascending: those that move and that edges constrain in every direction.
  std::vector<std::int64_t> vertices() const;
  /// Free vertices that have none, ascending: no active edge touches them, or edges leave them free in some direction,
  /// as a point seen from one place. The others do not depend on these.
  std::vector<std::int64_t> undetermined() const;

  /// What the rounding of H makes of the least known direction's variance, as a share of it, about: ε |z|ᵀ|H||z| / z_s
  /// for its column z of H⁻¹. Beyond 0.1 little can be said of what is known that badly: long chains without loops.
  double relativeError() const;

  /// Rows of a vertex's covariance. GraphError as for covariance().
  int dimension(std::int64_t id) const;

  // Whoever asks makes the matrices: with flags of its own (-march) Eigen may align and free memory in another way than
  // in the library.

  /// dimension × dimension, zero for a vertex that is fixed. GraphError if the graph has no such vertex, or if it has
  /// no covariance. O(1) for pairs of one edge and for single vertices, else O(nonzeros of the factor) for each scalar
  /// of `b`.
  Eigen::MatrixXd covariance(std::int64_t id) const { return covariance(id, id); }
  /// E[δa δbᵀ]: rows of a, columns of b.
  Eigen::MatrixXd covariance(std::int64_t a, std::int64_t b) const {
    Eigen::MatrixXd block(dimension(a), dimension(b));
    copyBlock(a, b, block.data());
    return block;
  }
  /// Of several vertices together, in the order given.
  Eigen::MatrixXd joint(std::span<const std::int64_t> ids) const {
    Eigen::Index scalars = 0;
    for (const std::int64_t id : ids) scalars += dimension(id);
    Eigen::MatrixXd all(scalars, scalars);
    copyJoint(ids, all.data());
    return all;
  }

 private:
  /// Column-major, to memory of the caller's.
  void copyBlock(std::int64_t a, std::int64_t b, double* out) const;
  void copyJoint(std::span<const std::int64_t> ids, double* out) const;

  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace quiver
