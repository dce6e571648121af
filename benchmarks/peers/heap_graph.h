#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace quiver::bench {

/// Linearisation as object-oriented frameworks do it: edges on the heap, behind virtual calls, each with its own error,
/// Jacobians and pointers into the blocks of H. Double, Eigen, analytic Jacobians, one edge at a time.
class HeapEdge {
 public:
  virtual ~HeapEdge() = default;
  virtual void computeError() = 0;
  virtual void linearizeOplus() = 0;
  virtual void addToHessian() = 0;
  virtual double chi2() const = 0;
};

struct HeapVertex {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Vector3d planar = Eigen::Vector3d::Zero();
  std::vector<double> diagonal;
  std::vector<double> gradient;
};

/// Vertices, edges, and blocks of H for both types of edges.
class HeapGraph {
 public:
  HeapVertex& addVertex(int dimension);
  void addPlanarEdge(HeapVertex& from, HeapVertex& to, const Eigen::Vector3d& z, const Eigen::Matrix3d& information);
  void addSpatialEdge(HeapVertex& from, HeapVertex& to, const Eigen::Isometry3d& z,
                      const Eigen::Matrix<double, 6, 6>& information);

  /// Errors, Jacobians, H and b of all edges; returns chi2.
  double linearize();
  /// ‖b‖², to compare with.
  double gradientSquare() const;

 private:
  std::vector<std::unique_ptr<HeapVertex>> vertices_;
  std::vector<std::unique_ptr<HeapEdge>> edges_;
  std::vector<std::unique_ptr<double[]>> offDiagonal_;
};

}  // namespace quiver::bench
