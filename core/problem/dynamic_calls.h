#pragma once

#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <quiver/core/problem/edge_functions.h>
#include <quiver/core/util/type_name.h>

namespace quiver::detail {

/// Throws GraphError unless an error has as many rows as the information matrix of its edge.
/// An error has at least one number.
void requireError(const Edge& edge, std::string_view type, int dimension);
void requireErrorSize(const Edge& edge, std::string_view type, Eigen::Index found, int expected);
/// Throws GraphError unless oplus has returned an estimate of the size it was given.
void requireEstimateSize(std::string_view type, Eigen::Index found, int expected);
/// Throws GraphError unless linearizeOplus has left a block the size it was given with.
void requireBlockSize(const Edge& edge, std::string_view type, Eigen::Index rows, Eigen::Index columns,
                      int expectedRows, int expectedColumns);

/// One role of an edge whose shape is known at run time: a vertex type, or any number of one.
template <typename T>
struct DynamicRole {
  using Vertex = T;
  static constexpr bool any = false;
};
template <typename T>
struct DynamicRole<AnyNumberOf<T>> {
  using Vertex = T;
  static constexpr bool any = true;
};

/// Estimates in scalar S: packable ones rebound, vectors of run-time size as they are.
template <typename Estimate, typename S>
struct DynamicEstimate {
  using Type = typename Packing<Estimate>::template Rebind<S>;
  static Type fromNumbers(const S* numbers, int) { return Packing<Estimate>::template load<S>(numbers); }
};
template <typename S>
struct DynamicEstimate<Vector<double, Dynamic>, S> {
  using Type = Vector<S, Dynamic>;
  static Type fromNumbers(const S* numbers, int count) { return Eigen::Map<const Type>(numbers, count); }
};

/// The calls of an edge type of run-time shape, for a scalar S.
template <typename E, typename Vertices = typename E::VertexTypes, typename Parameters = typename E::Parameters>
struct DynamicCalls;

template <typename E, typename... V, typename... P>
struct DynamicCalls<E, std::tuple<V...>, ParameterList<P...>> {
  static constexpr int rows = E::errorDimension;
  static constexpr int roles = sizeof...(V);
  using M = typename E::Measurement;
  template <typename S>
  using MeasurementOf = typename RebindMeasurement<M, S>::Type;
  template <typename T, typename S>
  using EstimateOf = typename DynamicEstimate<typename DynamicRole<T>::Vertex::Estimate, S>::Type;
  /// What computeError takes for a role.
  template <typename T, typename S>
  using Argument = std::conditional_t<DynamicRole<T>::any, std::span<const EstimateOf<T, S>>, const EstimateOf<T, S>&>;
  template <typename T>
  using BlockArgument =
      std::conditional_t<DynamicRole<T>::any, std::span<Matrix<double, rows, DynamicRole<T>::Vertex::dimension>>,
                         Matrix<double, rows, DynamicRole<T>::Vertex::dimension>&>;
  template <typename S>
  using Values = std::tuple<std::vector<EstimateOf<V, S>>...>;
  using BlockLists = std::tuple<std::vector<Matrix<double, rows, DynamicRole<V>::Vertex::dimension>>...>;
  template <typename S>
  using ParameterValues = std::tuple<typename Packing<typename P::Value>::template Rebind<S>...>;
  static constexpr int constants = (0 + ... + Packing<typename P::Value>::size);

  template <typename S>
  static constexpr bool hasError = requires(const E& e, const MeasurementOf<S>& m,
                                            const typename Packing<typename P::Value>::template Rebind<S>&... p,
                                            Argument<V, S>... x) {
    { e.computeError(m, p..., x...) } -> std::same_as<Vector<S, rows>>;
  };
  static constexpr bool hasJacobian =
      requires(const E& e, const M& m, const typename P::Value&... p, Argument<V, double>... x, BlockArgument<V>... J) {
    e.linearizeOplus(m, p..., x..., J...);
  };
  template <typename T, typename S>
  static constexpr bool roleRetracts = requires(const EstimateOf<T, S>& x,
                                                const Vector<S, DynamicRole<T>::Vertex::dimension>& delta) {
    { DynamicRole<T>::Vertex::oplus(x, delta) } -> std::convertible_to<EstimateOf<T, S>>;
  };
  template <typename S>
  static constexpr bool retracts = (roleRetracts<V, S> && ...);

  template <int I, typename S>
  static Argument<std::tuple_element_t<I, std::tuple<V...>>, S> argument(const Values<S>& x) {
    const auto& list = std::get<I>(x);
    if constexpr (DynamicRole<std::tuple_element_t<I, std::tuple<V...>>>::any) {
      return {list.data(), list.size()};
    } else {
      return list.front();
    }
  }
  template <int I>
  static BlockArgument<std::tuple_element_t<I, std::tuple<V...>>> block(BlockLists& J) {
    auto& list = std::get<I>(J);
    if constexpr (DynamicRole<std::tuple_element_t<I, std::tuple<V...>>>::any) {
      return {list.data(), list.size()};
    } else {
      return list.front();
    }
  }

  template <typename S>
  static Vector<S, rows> error(const E& edge, const MeasurementOf<S>& m, const ParameterValues<S>& p,
                               const Values<S>& x) {
    return [&]<int... A, int... B>(std::integer_sequence<int, A...>, std::integer_sequence<int, B...>) {
      Vector<S, rows> result = edge.computeError(m, std::get<A>(p)..., argument<B, S>(x)...);
      if constexpr (rows == Dynamic)
        requireErrorSize(edge, typeName<E>(), result.size(), edge.informationStore().dimension());
      return result;
    }
    (std::make_integer_sequence<int, sizeof...(P)>(), std::make_integer_sequence<int, roles>());
  }
  static void jacobian(const E& edge, const M& m, const ParameterValues<double>& p, const Values<double>& x,
                       BlockLists& J) {
    [&]<int... A, int... B>(std::integer_sequence<int, A...>, std::integer_sequence<int, B...>) {
      edge.linearizeOplus(m, std::get<A>(p)..., argument<B, double>(x)..., block<B>(J)...);
    }
    (std::make_integer_sequence<int, sizeof...(P)>(), std::make_integer_sequence<int, roles>());
  }
};

}  // namespace quiver::detail
