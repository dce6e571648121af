#pragma once

#include <string_view>

namespace quiver {

/// ρ, ρ' and ρ'' at one squared error.
struct RobustValue {
  double rho;
  double weight;
  double second;
};

/// A family of robust kernels: a constant, owned by the library or by a registry.
struct RobustKernelType {
  std::string_view name;
  /// ρ(e) and its derivatives by e, e = eᵀΩe ≥ 0 the squared Mahalanobis error; ρ(0) = 0, ρ'(0) = 1.
  RobustValue (*evaluate)(double squaredError, double width, double shape);
  /// What the width means, with its unit, and the formula.
  std::string_view documentation;
  bool hasShape = false;
  double defaultShape = 0.0;
};

/// A robust kernel of an edge: it replaces eᵀΩe by ρ(eᵀΩe) in the cost. A small value; the default is no kernel, ρ(e) =
/// e.
class RobustKernel {
 public:
  RobustKernel() = default;
  /// `type` must outlive the kernel. Throws GraphError unless width > 0 and finite.
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

 private:
  const RobustKernelType* type_ = nullptr;
  double width_ = 1.0;
  double shape_ = 0.0;
};

const RobustKernelType& huberKernel();
const RobustKernelType& cauchyKernel();
const RobustKernelType& tukeyKernel();

/// ρ = e for e ≤ δ², else 2δ√e − δ².
struct RobustKernelHuber : RobustKernel {
  explicit RobustKernelHuber(double width = 1.0) : RobustKernel(huberKernel(), width) {}
};
/// ρ = δ² ln(1 + e/δ²).
struct RobustKernelCauchy : RobustKernel {
  explicit RobustKernelCauchy(double width = 1.0) : RobustKernel(cauchyKernel(), width) {}
};
/// ρ = δ²/3 (1 − (1 − e/δ²)³) for e ≤ δ², else δ²/3.
struct RobustKernelTukey : RobustKernel {
  explicit RobustKernelTukey(double width = 1.0) : RobustKernel(tukeyKernel(), width) {}
};

}  // namespace quiver
