#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace quiver {

/// ρ, ρ' and ρ'' at one squared error.
struct RobustValue {
  double rho;
  double weight;
  double second;
};

/// The same at many squared errors, an array each; `second` may be null.
struct RobustValues {
  double* rho;
  double* weight;
  double* second;
};

/// How a robust kernel enters the normal equations of an edge with whitened residual r and Jacobian J. Both give the
/// exact gradient ρ' Jᵀr.
enum class RobustCorrection {
  first,  ///< H = ρ' JᵀJ: iteratively reweighted least squares, whose steps never overshoot a concave ρ
  second  ///< H = ρ' JᵀJ + 2ρ'' JᵀrrᵀJ, Triggs' correction, where it is positive definite; else as `first`
};

/// A family of robust kernels: a constant, owned by the library or by a registry.
struct RobustKernelType {
  std::string_view name;
  /// ρ(e) and its derivatives by e, e = eᵀΩe ≥ 0 the squared Mahalanobis error; ρ(0) = 0, ρ'(0) = 1,
  /// ρ(e) ≥ 0 and ρ'(e) ≥ 0 everywhere.
  RobustValue (*evaluate)(double squaredError, double width, double shape);
  /// What the width means, with its unit, and the formula.
  std::string_view documentation;
  bool hasShape = false;
  double defaultShape = 0.0;
  /// The width is in units of e, squared standard deviations, and not in standard deviations.
  bool squaredWidth = false;
  /// `evaluate` for many squared errors at once, the same numbers faster; may be left out.
  void (*evaluateAll)(std::span<const double> squaredErrors, double width, double shape,
                      const RobustValues& values) = nullptr;

  /// The width at which the kernel departs from the square where the squared error of a residual of that dimension,
  /// χ²-distributed, stays with that probability. Throws GraphError unless 0 < probability < 1 and dimension ≥ 1.
  double widthOf(double probability, int dimension) const;
};

/// A robust kernel of an edge: it replaces eᵀΩe by ρ(eᵀΩe) in the cost. A small value; the default is no kernel, ρ(e) =
/// e.
class RobustKernel {
 public:
  RobustKernel() = default;
  /// `type` must outlive the kernel. Throws GraphError unless width > 0, and it and its square are in range.
  RobustKernel(const RobustKernelType& type, double width, double shape);
  RobustKernel(const RobustKernelType& type, double width) : RobustKernel(type, width, type.defaultShape) {}

  explicit operator bool() const { return type_ != nullptr; }
  std::string_view name() const { return type_ ? type_->name : std::string_view("none"); }
  const RobustKernelType* type() const { return type_; }
  double width() const { return width_; }
  double shape() const { return shape_; }

  RobustValue evaluate(double squaredError) const {
    return type_ ? type_->evaluate(squaredError, width_, shape_) : RobustValue{squaredError, 1.0, 0.0};
  }
  /// The same for all of them.
  void evaluate(std::span<const double> squaredErrors, const RobustValues& values) const {
    if (type_ && type_->evaluateAll) return type_->evaluateAll(squaredErrors, width_, shape_, values);
    for (std::size_t i = 0; i < squaredErrors.size(); ++i) {
      const RobustValue value = evaluate(squaredErrors[i]);
      values.rho[i] = value.rho;
      values.weight[i] = value.weight;
      if (values.second) values.second[i] = value.second;
    }
  }

  /// Whether both are the same function.
  bool operator==(const RobustKernel&) const = default;

 private:
  const RobustKernelType* type_ = nullptr;
  double width_ = 1.0;
  double shape_ = 0.0;
};

}  // namespace quiver
