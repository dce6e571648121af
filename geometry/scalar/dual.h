#pragma once

/// \file
/// Forward-mode automatic differentiation: a value and its derivatives along N directions.

#include <quiver/geometry/scalar/lanes.h>
#include <quiver/geometry/scalar/select.h>
#include <Eigen/Core>
#include <concepts>
#include <type_traits>

namespace quiver {

template <class T, int N>
struct Dual;

namespace detail {
/// Numbers that mix with Dual<T, N> without derivatives of their own.
template <class U, class T>
concept ConstantOf = std::same_as<U, T> || std::is_arithmetic_v<U>;
}  // namespace detail

/// value + gradient . epsilon over T = double or Lanes. Comparisons compare values; assignment from a constant clears
/// the gradient. Operations touch every direction; directions that are literally 0.0 fold away in batch loops.
template <class T, int N>
struct Dual {
  static_assert(N >= 1);
  T value;
  T gradient[N];

  Dual() = default;
  /// A constant.
  template <detail::ConstantOf<T> U>
  Dual(const U& constant) : value(constant) {
    QUIVER_UNROLL for (int i = 0; i < N; ++i) gradient[i] = T(0.0);
  }
  /// The independent variable number `direction`.
  Dual(const T& at, int direction) : value(at) {
    QUIVER_UNROLL for (int i = 0; i < N; ++i) gradient[i] = T(i == direction ? 1.0 : 0.0);
  }

  Dual& operator+=(const Dual& b) {
    value += b.value;
    QUIVER_UNROLL for (int i = 0; i < N; ++i) gradient[i] += b.gradient[i];
    return *this;
  }
  Dual& operator-=(const Dual& b) {
    value -= b.value;
    QUIVER_UNROLL for (int i = 0; i < N; ++i) gradient[i] -= b.gradient[i];
    return *this;
  }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }

  template <detail::ConstantOf<T> U>
  Dual& operator+=(const U& b) {
    value += T(b);
    return *this;
  }
  template <detail::ConstantOf<T> U>
  Dual& operator-=(const U& b) {
    value -= T(b);
    return *this;
  }
  template <detail::ConstantOf<T> U>
  Dual& operator*=(const U& b) {
    return *this = *this * b;
  }
  template <detail::ConstantOf<T> U>
  Dual& operator/=(const U& b) {
    return *this = *this / b;
  }

  friend Dual operator+(const Dual& a) { return a; }
  friend Dual operator-(const Dual& a) {
    Dual r;
    r.value = -a.value;
    QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] = -a.gradient[i];
    return r;
  }
  friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r;
    r.value = a.value + b.value;
    QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] = a.gradient[i] + b.gradient[i];
    return r;
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r;
    r.value = a.value - b.value;
    QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] = a.gradient[i] - b.gradient[i];
    return r;
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r;
    r.value = a.value * b.value;
    QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] = a.value * b.gradient[i] + b.value * a.gradient[i];
    return r;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    Dual r;
    const T inverse = T(1.0) / b.value;
    r.value = a.value / b.value;
    QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] = (a.gradient[i] - r.value * b.gradient[i]) * inverse;
    return r;
  }

  template <detail::ConstantOf<T> U>
  friend Dual operator+(const Dual& a, const U& b) {
    Dual r(a);
    r.value += T(b);
    return r;
  }
  template <detail::ConstantOf<T> U>
  friend Dual operator+(const U& a, const Dual& b) {
    return b + a;
  }
  template <detail::ConstantOf<T> U>
  friend Dual operator-(const Dual& a, const U& b) {
    Dual r(a);
    r.value -= T(b);
    return r;
  }
  template <detail::ConstantOf<T> U>
  friend Dual operator-(const U& a, const Dual& b) {
    return -b + a;
  }
  template <detail::ConstantOf<T> U>
  friend Dual operator*(const Dual& a, const U& b) {
    return a.scaled(a.value * T(b), T(b));
  }
  template <detail::ConstantOf<T> U>
  friend Dual operator*(const U& a, const Dual& b) {
    return b * a;
  }
  template <detail::ConstantOf<T> U>
  friend Dual operator/(const Dual& a, const U& b) {
    return a.scaled(a.value / T(b), T(1.0) / T(b));
  }
  template <detail::ConstantOf<T> U>
  friend Dual operator/(const U& a, const Dual& b) {
    const T quotient = T(a) / b.value;
    return b.scaled(quotient, -quotient / b.value);
  }

  friend auto operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend auto operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend auto operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend auto operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
  friend auto operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend auto operator!=(const Dual& a, const Dual& b) { return a.value != b.value; }

  /// a where the mask (a bool over double) is true, b elsewhere: derivatives follow the chosen side.
  friend Dual select(const MaskOf<T>& mask, const Dual& a, const Dual& b) {
    Dual r;
    r.value = select(mask, a.value, b.value);
    QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] = select(mask, a.gradient[i], b.gradient[i]);
    return r;
  }
  friend Dual min(const Dual& a, const Dual& b) { return select(b.value < a.value, b, a); }
  friend Dual max(const Dual& a, const Dual& b) { return select(a.value < b.value, b, a); }
  friend Dual signOf(const Dual& x) { return Dual(signOf(x.value)); }
  friend T valueOf(const Dual& x) { return x.value; }

  /// The chain rule: `at` with this gradient times `slope`.
  Dual scaled(const T& at, const T& slope) const {
    Dual r;
    r.value = at;
    QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] = slope * gradient[i];
    return r;
  }
};

/// True for every `Dual`.
template <class T>
inline constexpr bool isDual = false;
template <class T, int N>
inline constexpr bool isDual<Dual<T, N>> = true;

}  // namespace quiver

namespace Eigen {

template <class T, int N>
struct NumTraits<quiver::Dual<T, N>> : NumTraits<double> {
  using Real = quiver::Dual<T, N>;
  using NonInteger = quiver::Dual<T, N>;
  using Literal = quiver::Dual<T, N>;
  using Nested = quiver::Dual<T, N>;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = N + 1,
    AddCost = N + 1,
    MulCost = 3 * N + 1
  };
};

template <class T, int N, class Operation>
struct ScalarBinaryOpTraits<quiver::Dual<T, N>, T, Operation> {
  using ReturnType = quiver::Dual<T, N>;
};
template <class T, int N, class Operation>
struct ScalarBinaryOpTraits<T, quiver::Dual<T, N>, Operation> {
  using ReturnType = quiver::Dual<T, N>;
};
template <class Isa, int N, class Operation>
struct ScalarBinaryOpTraits<quiver::Dual<quiver::Lanes<Isa>, N>, double, Operation> {
  using ReturnType = quiver::Dual<quiver::Lanes<Isa>, N>;
};
template <class Isa, int N, class Operation>
struct ScalarBinaryOpTraits<double, quiver::Dual<quiver::Lanes<Isa>, N>, Operation> {
  using ReturnType = quiver::Dual<quiver::Lanes<Isa>, N>;
};

}  // namespace Eigen
