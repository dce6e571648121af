#pragma once

#include <span>

namespace quiver {

/// Of a gradient g: ‖g‖∞, the largest gᵢ²/dᵢ over positive d, and Σ 0 gᵢ, which is 0 if all is finite.
struct GradientSize {
  double largest = 0.0;
  double quotient = 0.0;
  double zero = 0.0;
};

/// Of a piece of g and the diagonal d. O(scalars), with a division only where the largest quotient grows.
GradientSize sizeOf(std::span<const double> g, std::span<const double> d);

/// Of two pieces together.
GradientSize joinSizes(const GradientSize& a, const GradientSize& b);

}  // namespace quiver
