#pragma once

#include <quiver/core/graph/robust_kernel.h>

namespace quiver {

class Registry;

// Everywhere e = eᵀΩe, δ the width in standard deviations.

const RobustKernelType& huberKernel();
const RobustKernelType& cauchyKernel();
const RobustKernelType& tukeyKernel();
const RobustKernelType& pseudoHuberKernel();
const RobustKernelType& gemanMcClureKernel();
const RobustKernelType& welschKernel();
const RobustKernelType& fairKernel();
const RobustKernelType& saturatedKernel();
const RobustKernelType& dcsKernel();
const RobustKernelType& barronKernel();
const RobustKernelType& arctanKernel();

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
/// ρ = 2δ² (√(1 + e/δ²) − 1).
struct RobustKernelPseudoHuber : RobustKernel {
  explicit RobustKernelPseudoHuber(double width = 1.0) : RobustKernel(pseudoHuberKernel(), width) {}
};
/// ρ = w e / (w + e): bounded by w. The width is in units of e, squared standard deviations, as in g2o.
struct RobustKernelGemanMcClure : RobustKernel {
  explicit RobustKernelGemanMcClure(double width = 1.0) : RobustKernel(gemanMcClureKernel(), width) {}
};
/// ρ = δ² (1 − exp(−e/δ²)): bounded by δ².
struct RobustKernelWelsch : RobustKernel {
  explicit RobustKernelWelsch(double width = 1.0) : RobustKernel(welschKernel(), width) {}
};
/// ρ = 2δ² (√e/δ − ln(1 + √e/δ)). ρ'' is unbounded at 0; 0 is given there.
struct RobustKernelFair : RobustKernel {
  explicit RobustKernelFair(double width = 1.0) : RobustKernel(fairKernel(), width) {}
};
/// ρ = min(e, δ²).
struct RobustKernelSaturated : RobustKernel {
  explicit RobustKernelSaturated(double width = 1.0) : RobustKernel(saturatedKernel(), width) {}
};
/// Dynamic covariance scaling: ρ = e for e ≤ Φ, else Φ (3e − Φ) / (Φ + e), whose derivative (2Φ / (Φ + e))² is the
/// paper's weight s² (g2o differentiates s² e instead, with weights below zero). Φ is in units of e.
struct RobustKernelDCS : RobustKernel {
  explicit RobustKernelDCS(double width = 1.0) : RobustKernel(dcsKernel(), width) {}
};
/// Barron's general kernel, ρ = 2δ² |α−2|/α ((1 + e/(δ² |α−2|))^(α/2) − 1) with shape α: 2 is no kernel, 1
/// pseudo-Huber, 0 Cauchy of width √2 δ, −2 Geman–McClure of width 4δ², towards −∞ Welsch of width √2 δ.
struct RobustKernelBarron : RobustKernel {
  explicit RobustKernelBarron(double width = 1.0, double shape = 1.0) : RobustKernel(barronKernel(), width, shape) {}
};
/// ρ = δ² arctan(e/δ²): bounded by δ² π/2.
struct RobustKernelArctan : RobustKernel {
  explicit RobustKernelArctan(double width = 1.0) : RobustKernel(arctanKernel(), width) {}
};

/// Makes every kernel known by its name: Huber, PseudoHuber, Cauchy, GemanMcClure, Welsch, Fair, Tukey, Saturated, DCS,
/// Barron, Arctan. Throws GraphError if one of the names is taken.
void registerRobustKernels(Registry& registry);

}  // namespace quiver
