#pragma once

#include <gtest/gtest.h>

#include <quiver/geometry/scalar/scalar.h>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

namespace quiver::test {

/// Whether this machine can run code for Isa.
template <class Isa>
inline bool runs() {
  const InstructionSet best = detectInstructionSet();
  if (std::is_same_v<Isa, isa::Avx512>) return !QUIVER_NATIVE_LANES || best >= InstructionSet::avx512;
  if (std::is_same_v<Isa, isa::Avx2>) return !QUIVER_NATIVE_LANES || best >= InstructionSet::avx2;
  return true;
}

using AllIsas = ::testing::Types<isa::Generic, isa::Avx2, isa::Avx512>;

/// Representable numbers between a and b, signs included.
inline double ulpsBetween(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b) ? 0.0 : 1e300;
  if (a == b) return 0.0;
  std::int64_t i, j;
  std::memcpy(&i, &a, 8);
  std::memcpy(&j, &b, 8);
  if ((i < 0) != (j < 0)) return std::abs(a) + std::abs(b) < 1e-300 ? 1.0 : 1e300;
  return std::abs(static_cast<double>(i - j));
}

}  // namespace quiver::test
