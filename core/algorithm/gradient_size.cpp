#include <quiver/core/algorithm/gradient_size.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace quiver {

GradientSize sizeOf(std::span<const double> g, std::span<const double> d) {
  constexpr std::size_t chunk = 64;
  constexpr std::size_t lanes = 8;
  double largest[lanes] = {};
  double zero[lanes] = {};
  GradientSize size;
  for (std::size_t begin = 0; begin < g.size(); begin += chunk) {
    const std::size_t end = std::min(g.size(), begin + chunk);
    int above = 0;
    for (std::size_t i = begin; i + lanes <= end; i += lanes) {
      for (std::size_t k = 0; k < lanes; ++k) {
        const double x = g[i + k];
        largest[k] = std::max(largest[k], std::abs(x));
        zero[k] += 0.0 * x;
        above |= x * x > size.quotient * d[i + k] ? 1 : 0;
      }
    }
    for (std::size_t i = end - (end - begin) % lanes; i < end; ++i) {
      largest[0] = std::max(largest[0], std::abs(g[i]));
      zero[0] += 0.0 * g[i];
      above = 1;
    }
    for (std::size_t i = begin; above != 0 && i < end; ++i) {
      if (d[i] > 0.0) size.quotient = std::max(size.quotient, g[i] * g[i] / d[i]);
    }
  }
  size.largest = *std::max_element(largest, largest + lanes);
  for (const double z : zero) size.zero += z;
  return size;
}

GradientSize joinSizes(const GradientSize& a, const GradientSize& b) {
  return {std::max(a.largest, b.largest), std::max(a.quotient, b.quotient), a.zero + b.zero};
}

}  // namespace quiver
