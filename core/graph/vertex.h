#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <quiver/core/graph/change_flag.h>
#include <quiver/geometry/packing.h>

namespace quiver {

class Graph;

/// What all vertices have in common: an id, whether it is held fixed, whether it has an estimate. Knows nothing of any
/// solver.
///
/// Assigning one vertex to another copies what it says (estimate, held directions) and not where it belongs: id and
/// graph remain those of the vertex assigned to.
class Vertex {
 public:
  Vertex() = default;
  Vertex(const Vertex&) = default;
  Vertex& operator=(const Vertex& other) {
    fixed_ = other.fixed_;
    hasEstimate_ = other.hasEstimate_;
    change_.raise();
    return *this;
  }

  /// Unique in its graph, ≥ 0.
  std::int64_t id() const { return id_; }

  /// A fixed vertex takes part in edges but is not changed.
  void setFixed(bool fixed) { setFixedDirections(fixed ? allDirections : 0); }
  /// Holds the tangent directions whose bit is set (bit i is direction i, at most 63), exactly: the increment there is
  /// zero. A mask of all directions is the same as setFixed(true).
  void setFixedDirections(std::uint64_t mask) {
    fixed_ = mask;
    change_.raise();
  }
  std::uint64_t fixedDirections() const { return fixed_; }
  /// Whether every direction is held, by setFixed(true). (A mask that covers all directions of the dimension counts
  /// when compiled.)
  bool fixed() const { return fixed_ == allDirections; }

  /// A vertex without an estimate needs an initial guess before it can be optimised.
  bool hasEstimate() const { return hasEstimate_; }
  void setHasEstimate(bool has) {
    if (has == hasEstimate_) return;
    hasEstimate_ = has;
    change_.raise();
  }

  /// Index of its type in the registry of its graph.
  int type() const { return type_; }

  static constexpr std::uint64_t allDirections = ~std::uint64_t{0};

 protected:
  /// To be called after a change of anything but the numbers of the estimate.
  void noteChange() { change_.raise(); }

 private:
  friend class Graph;
  ChangeLink change_;
  std::int64_t id_ = -1;
  std::uint64_t fixed_ = 0;
  std::uint16_t type_ = 0;
  bool hasEstimate_ = false;
};

/// A vertex is an estimate and a retraction.
///
/// `Derived` supplies `template <typename S> static Estimate<S> oplus(const Estimate<S>& x, const Vector<S, D>&
/// delta)`, the estimate moved by a tangent vector; a version for `double` alone is enough, but then edges that rely on
/// dual numbers fall back to numeric Jacobians. Optional: `static constexpr std::array tangent{"x [m]", …}` names the
/// tangent's directions.
///
/// `D` is the tangent's dimension, or Dynamic when `EstimateType` is a vector of run-time size: then the dimension is
/// the vector's size. Any estimate that `Packing` knows can be stored; specialise it for types of your own.
template <typename Derived, int D, typename EstimateType>
class BaseVertex : public Vertex {
  static_assert(Packable<EstimateType>, "specialise quiver::Packing for this estimate type, or use a vector");

 public:
  using Estimate = EstimateType;
  static constexpr int dimension = D;

  EstimateType estimate() const { return Packing<EstimateType>::template load<double>(values_.data()); }
  void setEstimate(const EstimateType& estimate) {
    Packing<EstimateType>::store(estimate, values_.data());
    setHasEstimate(true);
  }

  /// The estimate as the numbers that a problem's state holds.
  const double* values() const { return values_.data(); }
  double* values() { return values_.data(); }
  int valueCount() const { return Packing<EstimateType>::size; }

 private:
  std::array<double, static_cast<std::size_t>(Packing<EstimateType>::size)> values_ =
      detail::defaultNumbers<EstimateType>();
};

/// A vector whose size is known at run time only.
template <typename Derived>
class BaseVertex<Derived, Dynamic, Vector<double, Dynamic>> : public Vertex {
 public:
  using Estimate = Vector<double, Dynamic>;
  static constexpr int dimension = Dynamic;

  Estimate estimate() const { return Eigen::Map<const Estimate>(values_.data(), valueCount()); }
  void setEstimate(const Estimate& estimate) {
    if (estimate.size() != valueCount()) noteChange();
    values_.assign(estimate.data(), estimate.data() + estimate.size());
    setHasEstimate(true);
  }

  const double* values() const { return values_.data(); }
  double* values() { return values_.data(); }
  int valueCount() const { return static_cast<int>(values_.size()); }

 private:
  std::vector<double> values_;
};

}  // namespace quiver
