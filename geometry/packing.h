#pragma once

/// \file
/// Estimates and measurements as plain arrays of numbers.

#include <quiver/geometry/se2.h>
#include <quiver/geometry/se3.h>
#include <quiver/geometry/sim3.h>
#include <array>
#include <concepts>
#include <cstddef>
#include <type_traits>

namespace quiver {

/// How a value of type M lies in an array. Specialised with
///   size            doubles it occupies in memory (cached ones included),
///   coordinates     numbers that describe it in a file,
///   dimension       degrees of freedom,
///   Rebind<S>       M with S in place of double,
///   store, load     to and from such an array, bit by bit; load works on any scalar, store on M.
template <class M>
struct Packing;

namespace detail {

/// The numbers of M's default: of M(), zeros for matrices, and for types that have none.
template <class M>
constexpr bool defaultMayThrow = !std::is_nothrow_default_constructible_v<M> && !std::is_trivially_destructible_v<M>;
template <class M>
inline auto defaultNumbers() noexcept(!defaultMayThrow<M>) {
  std::array<double, static_cast<std::size_t>(Packing<M>::size)> numbers{};
  if constexpr (std::is_default_constructible_v<M> && !requires { M::Zero(); }) Packing<M>::store(M(), numbers.data());
  return numbers;
}

}  // namespace detail

template <>
struct Packing<double> {
  static constexpr int size = 1, coordinates = 1, dimension = 1;
  template <class S>
  using Rebind = S;
  template <class S>
  static void store(const S& m, S* out) {
    *out = m;
  }
  template <class S>
  static S load(const S* in) {
    return *in;
  }
};

/// Fixed-size matrices and vectors, by columns.
template <int R, int C, int Options, int MaxR, int MaxC>
requires(R >= 1 && C >= 1) struct Packing<Eigen::Matrix<double, R, C, Options, MaxR, MaxC>> {
  static constexpr int size = R * C, coordinates = R * C, dimension = R * C;
  template <class S>
  using Rebind = Eigen::Matrix<S, R, C>;
  template <class Values, class S>
  static void store(const Values& m, S* out) {
    QUIVER_UNROLL for (int j = 0; j < C; ++j) { QUIVER_UNROLL for (int i = 0; i < R; ++i) out[i + j * R] = m(i, j); }
  }
  template <class S>
  static Rebind<S> load(const S* in) {
    Rebind<S> m;
    QUIVER_UNROLL for (int j = 0; j < C; ++j) { QUIVER_UNROLL for (int i = 0; i < R; ++i) m(i, j) = in[i + j * R]; }
    return m;
  }
  /// Whether numbers that lie as S does are such a matrix.
  template <class S>
  static constexpr bool viewable = sizeof(Rebind<S>) == size * sizeof(S) && alignof(Rebind<S>) <= alignof(S);
  /// The matrix where its numbers lie: a long one is not carried from there to the stack.
  template <class S>
  requires(viewable<S>) static const Rebind<S>& view(const S* in) { return *reinterpret_cast<const Rebind<S>*>(in); }
};

template <>
struct Packing<SO2<double>> {
  static constexpr int size = 3, coordinates = 1, dimension = 1;
  template <class S>
  using Rebind = SO2<S>;
  template <class S>
  static void store(const SO2<S>& m, S* out) {
    out[0] = m.angle();
    out[1] = m.cosine();
    out[2] = m.sine();
  }
  template <class S>
  static SO2<S> load(const S* in) {
    return SO2<S>(in[0], in[1], in[2]);
  }
};

/// x, y, angle, cosine, sine.
template <>
struct Packing<SE2<double>> {
  static constexpr int size = 5, coordinates = 3, dimension = 3;
  template <class S>
  using Rebind = SE2<S>;
  template <class S>
  static void store(const SE2<S>& m, S* out) {
    out[0] = m.x();
    out[1] = m.y();
    Packing<SO2<double>>::store(m.rotation(), out + 2);
  }
  template <class S>
  static SE2<S> load(const S* in) {
    return SE2<S>(Vector<S, 2>(in[0], in[1]), Packing<SO2<double>>::load(in + 2));
  }
};

/// The quaternion x, y, z, w.
template <>
struct Packing<SO3<double>> {
  static constexpr int size = 4, coordinates = 4, dimension = 3;
  template <class S>
  using Rebind = SO3<S>;
  template <class S>
  static void store(const SO3<S>& m, S* out) {
    out[0] = m.x();
    out[1] = m.y();
    out[2] = m.z();
    out[3] = m.w();
  }
  template <class S>
  static SO3<S> load(const S* in) {
    return SO3<S>::fromUnit(in[0], in[1], in[2], in[3]);
  }
};

/// Translation, then the quaternion.
template <>
struct Packing<SE3<double>> {
  static constexpr int size = 7, coordinates = 7, dimension = 6;
  template <class S>
  using Rebind = SE3<S>;
  template <class S>
  static void store(const SE3<S>& m, S* out) {
    Packing<Vector<double, 3>>::store(m.translation(), out);
    Packing<SO3<double>>::store(m.rotation(), out + 3);
  }
  template <class S>
  static SE3<S> load(const S* in) {
    return SE3<S>(Packing<SO3<double>>::load(in + 3), Vector<S, 3>(in[0], in[1], in[2]));
  }
};

/// Translation, the quaternion, the scale.
template <>
struct Packing<Sim3<double>> {
  static constexpr int size = 8, coordinates = 8, dimension = 7;
  template <class S>
  using Rebind = Sim3<S>;
  template <class S>
  static void store(const Sim3<S>& m, S* out) {
    Packing<Vector<double, 3>>::store(m.translation(), out);
    Packing<SO3<double>>::store(m.rotation(), out + 3);
    out[7] = m.scale();
  }
  template <class S>
  static Sim3<S> load(const S* in) {
    return Sim3<S>(Packing<SO3<double>>::load(in + 3), Vector<S, 3>(in[0], in[1], in[2]), in[7]);
  }
};

/// Types with a Packing.
template <class M>
concept Packable = requires(const M& m, double* out, const double* in) {
  { Packing<M>::size } -> std::convertible_to<int>;
  Packing<M>::store(m, out);
  {Packing<M>::load(in)};
};

/// M with S in place of double.
template <class M, class S>
using Rebound = typename Packing<M>::template Rebind<S>;

static_assert(alignof(SE2<double>) <= 8 && alignof(SE3<double>) <= 8 && alignof(Sim3<double>) <= 8);
static_assert(sizeof(SE2<double>) == 5 * sizeof(double) && sizeof(SE3<double>) == 7 * sizeof(double));

}  // namespace quiver
