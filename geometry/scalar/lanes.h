#pragma once

/// \file
/// Eight doubles side by side, as a scalar: `Lanes<Isa>` for the instruction sets of isa.h.
///
/// Lanes offer the operators of double (mixed with double too), comparisons that give a `LanesMask`, and by
/// argument-dependent lookup sqrt, abs, min, max, floor, rint, fma, copysign, isfinite here and the transcendental
/// functions in lanes_math.h. There is no `if` on a comparison: use select(mask, a, b). They are fast inside a batch
/// loop of their instruction set (QUIVER_BATCH_LOOP_*) and merely right elsewhere; running one on a machine without
/// the instruction set is undefined.

#include <quiver/geometry/scalar/isa.h>
#include <Eigen/Core>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <type_traits>

namespace quiver {

#if QUIVER_NATIVE_LANES
// Compiler builtins instead of <immintrin.h>, whose 53000 lines would take half a second in every file.
namespace detail {
typedef double Eight __attribute__((vector_size(64)));
typedef long long EightBits __attribute__((vector_size(64)));
typedef double Four __attribute__((vector_size(32)));
constexpr int toNearest = 8, down = 9;  // _MM_FROUND_*, without exceptions
constexpr int asRoundingIsSet = 4;      // _MM_FROUND_CUR_DIRECTION
}  // namespace detail
#endif

template <class Isa>
class Lanes;
template <class Isa>
class LanesMask;

#define QUIVER_LANES_ISA isa::Generic
#define QUIVER_LANES_TARGET QUIVER_TARGET_GENERIC
#define QUIVER_LANES_NATIVE 1
#include <quiver/geometry/scalar/lanes_definition.h>

#define QUIVER_LANES_ISA isa::Avx2
#define QUIVER_LANES_TARGET QUIVER_TARGET_AVX2
#if QUIVER_NATIVE_LANES
#  define QUIVER_LANES_NATIVE 4
#else
#  define QUIVER_LANES_NATIVE 1
#endif
#include <quiver/geometry/scalar/lanes_definition.h>

#define QUIVER_LANES_ISA isa::Avx512
#define QUIVER_LANES_TARGET QUIVER_TARGET_AVX512
#if QUIVER_NATIVE_LANES
#  define QUIVER_LANES_NATIVE 8
#else
#  define QUIVER_LANES_NATIVE 1
#endif
#include <quiver/geometry/scalar/lanes_definition.h>

/// True for every `Lanes<Isa>`.
template <class T>
inline constexpr bool isLanes = false;
template <class Isa>
inline constexpr bool isLanes<Lanes<Isa>> = true;

/// What comparing two numbers of type T gives: bool, or a mask for lanes.
template <class T>
using MaskOf = std::remove_cvref_t<decltype(std::declval<const T&>() < std::declval<const T&>())>;

}  // namespace quiver

namespace Eigen {

template <class Isa>
struct NumTraits<quiver::Lanes<Isa>> : NumTraits<double> {
  using Real = quiver::Lanes<Isa>;
  using NonInteger = quiver::Lanes<Isa>;
  using Literal = quiver::Lanes<Isa>;
  using Nested = quiver::Lanes<Isa>;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

template <class Isa, class Operation>
struct ScalarBinaryOpTraits<quiver::Lanes<Isa>, double, Operation> {
  using ReturnType = quiver::Lanes<Isa>;
};
template <class Isa, class Operation>
struct ScalarBinaryOpTraits<double, quiver::Lanes<Isa>, Operation> {
  using ReturnType = quiver::Lanes<Isa>;
};

}  // namespace Eigen
