#pragma once

#include <concepts>
#include <tuple>
#include <type_traits>
#include <utility>

#include <quiver/core/graph/edge.h>
#include <quiver/geometry/linear.h>
#include <quiver/geometry/packing.h>

namespace quiver::detail {

/// A measurement in scalar S: packable ones are rebound, others exist in double alone.
template <typename M, typename S>
struct RebindMeasurement {
  using Type = M;
};
template <Packable M, typename S>
struct RebindMeasurement<M, S> {
  using Type = typename Packing<M>::template Rebind<S>;
};

/// Which of the functions an edge type may offer it does offer, for a scalar type S. A form counts only if it returns
/// exactly Vector<S, N>: being callable is not enough, since Eigen converts.
template <typename E, typename Vertices = typename E::VertexTypes, typename Parameters = typename E::Parameters>
struct EdgeFunctions;

template <typename E, typename... V, typename... P>
struct EdgeFunctions<E, std::tuple<V...>, ParameterList<P...>> {
  static constexpr int arity = sizeof...(V);
  static constexpr int parameters = sizeof...(P);
  static constexpr int rows = E::errorDimension;
  using M = typename E::Measurement;
  static constexpr bool packableMeasurement = Packable<M>;

  template <typename S>
  using MeasurementOf = typename RebindMeasurement<M, S>::Type;
  template <typename T, typename S>
  using ValueOf = typename Packing<T>::template Rebind<S>;

  template <typename S>
  static constexpr bool staticError = requires(const MeasurementOf<S>& m, const ValueOf<typename P::Value, S>&... p,
                                               const ValueOf<typename V::Estimate, S>&... x) {
    { E::computeError(m, p..., x...) } -> std::same_as<Vector<S, rows>>;
  };
  template <typename S>
  static constexpr bool anyError = requires(const E& e, const MeasurementOf<S>& m,
                                            const ValueOf<typename P::Value, S>&... p,
                                            const ValueOf<typename V::Estimate, S>&... x) {
    { e.computeError(m, p..., x...) } -> std::same_as<Vector<S, rows>>;
  };
  template <typename S>
  static constexpr bool staticJacobian = requires(const MeasurementOf<S>& m, const ValueOf<typename P::Value, S>&... p,
                                                  const ValueOf<typename V::Estimate, S>&... x,
                                                  Matrix<S, rows, V::dimension>&... J) {
    E::linearizeOplus(m, p..., x..., J...);
  };
  template <typename S>
  static constexpr bool anyJacobian = requires(const E& e, const MeasurementOf<S>& m,
                                               const ValueOf<typename P::Value, S>&... p,
                                               const ValueOf<typename V::Estimate, S>&... x,
                                               Matrix<S, rows, V::dimension>&... J) {
    e.linearizeOplus(m, p..., x..., J...);
  };
  template <typename Vertex, typename S>
  static constexpr bool vertexRetracts = requires(const ValueOf<typename Vertex::Estimate, S>& x,
                                                  const Vector<S, Vertex::dimension>& delta) {
    { Vertex::oplus(x, delta) } -> std::convertible_to<ValueOf<typename Vertex::Estimate, S>>;
  };
  template <typename S>
  static constexpr bool retracts = (vertexRetracts<V, S> && ...);
};

/// Whether the type has something of that name, be it of the right form or not. (Of several overloads one cannot ask.)
template <typename E>
constexpr bool namesJacobian = requires {
  &E::linearizeOplus;
}
|| requires { &E::template linearizeOplus<double>; };

/// Whether `Jacobians::…` is what the type insists on.
template <typename E>
constexpr Jacobians requestedJacobians() {
  if constexpr (requires {
                  { E::jacobians } -> std::convertible_to<Jacobians>;
                }) {
    return E::jacobians;
  } else {
    return Jacobians::automatic;
  }
}

/// Whether the type allows eight edges side by side.
template <typename E>
constexpr bool requestsLanes() {
  if constexpr (requires {
                  { E::lanes } -> std::convertible_to<bool>;
                }) {
    return E::lanes;
  } else {
    return false;
  }
}

/// Whether every vertex has a compile-time dimension and the arity is fixed.
template <typename Vertices>
struct FixedVertices;
template <typename... V>
struct FixedVertices<std::tuple<V...>> {
  template <typename T>
  static constexpr bool isFixed = [] {
    if constexpr (requires { T::dimension; }) {
      return T::dimension != Dynamic;
    } else {
      return false;
    }
  }();
  static constexpr bool value = (isFixed<V> && ...);
};

template <typename E>
constexpr bool fixedShape() {
  return E::errorDimension != Dynamic && FixedVertices<typename E::VertexTypes>::value;
}

}  // namespace quiver::detail
