#pragma once

#include <quiver/core/problem/central_difference.h>
#include <quiver/core/problem/lane_loop.h>

namespace quiver::detail {

/// Central differences over the tangent of role I, the others held, about x where the error is `error`.
template <typename E, int I, typename Loop = EdgeLoop<E>>
inline void differentiate(const E& edge, const typename Loop::Functions::template MeasurementOf<double>& m,
                          const typename Loop::template ParameterValues<double>& p,
                          const Vector<double, Loop::rows>& error, typename Loop::template Estimates<double>& x,
                          typename Loop::template Blocks<double>& J) {
  using Vertex = std::tuple_element_t<static_cast<std::size_t>(I), typename E::VertexTypes>;
  const auto original = std::get<I>(x);
  for (int c = 0; c < Vertex::dimension; ++c) {
    Vector<double, Vertex::dimension> delta = Vector<double, Vertex::dimension>::Zero();
    const auto errorAt = [&](double step) {
      delta[c] = step;
      std::get<I>(x) = Vertex::oplus(original, delta);
      return Loop::template callError<double>(edge, m, p, x);
    };
    differentiateColumn(firstDifferenceStep<Vertex>(original, c), error, errorAt, std::get<I>(J).col(c));
  }
  std::get<I>(x) = original;
}

/// Whitens a block column by column and writes it to its lane.
template <int Rows, int Columns, typename Block>
inline void storeScalarBlock(const double* U, Whitening whitening, Block& J, double* out, int group, int lane) {
  for (int c = 0; c < Columns; ++c) {
    whiten<Rows>(U, whitening, J.col(c));
    for (int r = 0; r < Rows; ++r) out[((group * Columns + c) * Rows + r) * Panel::lanes + lane] = J(r, c);
  }
}

/// The estimates of one edge, role by role.
template <typename E>
inline typename EdgeLoop<E>::template Estimates<double> loadScalarEstimates(const BatchView& view, std::int32_t id) {
  using Loop = EdgeLoop<E>;
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    return typename Loop::template Estimates<double>(
        Packing<typename std::tuple_element_t<static_cast<std::size_t>(I), typename E::VertexTypes>::Estimate>::
            template load<double>(view.state + view.records[I * view.edges + id])...);
  }
  (std::make_integer_sequence<int, Loop::arity>());
}

/// One edge at a time, in double: for types whose functions take doubles alone, are members, or may branch.
template <typename E, Jacobians form, bool withJacobians>
inline void scalarLoop(const BatchView& view, const std::int32_t* edges, int count, const Panel& panel) {
  using Loop = EdgeLoop<E>;
  constexpr int rows = Loop::rows;
  constexpr int lanes = Panel::lanes;
  for (int i = 0; i < count; ++i) {
    if (view.stop != nullptr) view.stop->throwIfReached();
    const std::int32_t id = edges[i];
    const E& edge = *static_cast<const E*>(view.objects[id]);
    const double* constant = view.constants + std::int64_t{id} * view.numbers;
    const auto m = [&] {
      if constexpr (Packable<typename E::Measurement>) {
        return Packing<typename E::Measurement>::template load<double>(constant);
      } else {
        return edge.measurement();
      }
    }();
    const auto p = Loop::template parameterValues<double>(constant);
    auto x = loadScalarEstimates<E>(view, id);
    const double* U = constant + Loop::values;
    const int group = i / lanes;
    const int lane = i % lanes;
    Vector<double, rows> error;
    if constexpr (withJacobians) {
      typename Loop::template Blocks<double> J;
      if constexpr (form == Jacobians::dual) {
        error = Loop::template linearizeDual<double>(edge, m, p, x, J);
      } else {
        error = Loop::template callError<double>(edge, m, p, x);
        if constexpr (form == Jacobians::analytic) {
          Loop::template callJacobian<double>(edge, m, p, x, J);
        } else {
          [&]<int... I>(std::integer_sequence<int, I...>) { (differentiate<E, I>(edge, m, p, error, x, J), ...); }
          (std::make_integer_sequence<int, Loop::arity>());
        }
      }
      [&]<int... I>(std::integer_sequence<int, I...>) {
        (storeScalarBlock<rows, Loop::columns[I]>(U, view.whitening, std::get<I>(J), panel.jacobian[I], group, lane),
         ...);
      }
      (std::make_integer_sequence<int, Loop::arity>());
    } else {
      error = Loop::template callError<double>(edge, m, p, x);
    }
    whiten<rows>(U, view.whitening, error);
    double square = 0.0;
    for (int r = 0; r < rows; ++r) {
      square += error(r) * error(r);
      panel.residual[(group * rows + r) * lanes + lane] = error(r);
    }
    panel.squaredError[i] = square;
  }
}

}  // namespace quiver::detail
