#pragma once

#include <algorithm>
#include <cstddef>

namespace quiver {

/// Σ term(i) for i < count, in eight partial sums, so that no addition waits for the one before. Always in the same
/// order.
template <typename Term>
double sumInLanes(std::size_t count, const Term& term) {
  constexpr std::size_t lanes = 8;
  double sums[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t k = 0; k < lanes; ++k) sums[k] += term(i + k);
  }
  for (; i < count; ++i) sums[i % lanes] += term(i);
  for (std::size_t k = 1; k < lanes; ++k) sums[0] += sums[k];
  return sums[0];
}

/// The largest of 0 and term(i), i < count; not a number is ignored.
template <typename Term>
double largestInLanes(std::size_t count, const Term& term) {
  constexpr std::size_t lanes = 8;
  double largest[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t k = 0; k < lanes; ++k) largest[k] = std::max(largest[k], term(i + k));
  }
  for (; i < count; ++i) largest[i % lanes] = std::max(largest[i % lanes], term(i));
  return *std::max_element(largest, largest + lanes);
}

}  // namespace quiver
