#pragma once

#include <span>
#include <tuple>
#include <vector>

#include <quiver/core/problem/apply_kernels.h>
#include <quiver/core/problem/central_difference.h>
#include <quiver/core/problem/dynamic_calls.h>
#include <quiver/core/problem/edge_batch.h>
#include <quiver/core/problem/scalar_loop.h>
#include <quiver/core/problem/square_root.h>

namespace quiver::detail {

/// A batch of an edge type whose error dimension, arity or tangent dimensions are known at run time. One edge a call,
/// in double.
template <typename E>
class DynamicBatch final : public EdgeBatch {
  using Calls = DynamicCalls<E>;
  static constexpr int chunk = 8;
  using DualChunk = Dual<double, chunk>;
  static constexpr Jacobians requested = requestedJacobians<E>();
  static constexpr bool hasDual = Calls::template hasError<DualChunk> && Calls::template retracts<DualChunk>;
  static_assert(
      Calls::template hasError<double>,
      "computeError(measurement, parameters…, estimates…) must return exactly Vector<double, N>; AnyNumberOf<V> is a "
      "std::span<const Estimate>");
  static constexpr Jacobians form =
      requested != Jacobians::automatic
          ? requested
          : (Calls::hasJacobian ? Jacobians::analytic : (hasDual ? Jacobians::dual : Jacobians::numeric));

 public:
  explicit DynamicBatch(BatchSource& source) : EdgeBatch(source) {
    for (int i = 0; i < size(); ++i) {
      requireError(edge(i), typeName<E>(), typed(i).informationStore().dimension());
      for (const std::int32_t slot : slots(i)) {
        records_.push_back(source.layout.offset(slot));
        counts_.push_back(source.layout.valueCount(slot));
      }
      const EdgeShape one = shape(i);
      largest_.rows = std::max(largest_.rows, one.rows);
      largest_.columns.resize(std::max(largest_.columns.size(), one.columns.size()));
      for (std::size_t k = 0; k < one.columns.size(); ++k)
        largest_.columns[k] = std::max(largest_.columns[k], one.columns[k]);
    }
    refresh(source.graph, source.threads);
  }

  static EdgeForm describe() {
    const char* reasons[] = {"", "the type has linearizeOplus", "computeError takes dual numbers",
                             "neither linearizeOplus nor a computeError and oplus that take dual numbers"};
    return {form, false, requested != Jacobians::automatic ? "the type insists" : reasons[static_cast<int>(form)]};
  }

  bool uniform() const override { return false; }
  EdgeShape shape(int i) const override {
    EdgeShape result;
    result.rows = typed(i).informationStore().dimension();
    const std::size_t begin = first(i);
    const std::size_t count = slots(i).size();
    for (std::size_t k = 0; k < count; ++k)
      result.columns.push_back(dimensionAt(static_cast<int>(k), counts_[begin + k]));
    return result;
  }
  EdgeShape largestShape() const override { return largest_; }

  void evaluate(const State& state, std::span<const std::int32_t> edges, const Panel& panel) const override {
    run(state, edges, panel, false);
  }
  void linearize(const State& state, std::span<const std::int32_t> edges, const Panel& panel) const override {
    run(state, edges, panel, true);
  }
  bool robust() const override { return !kernels_.none(); }
  void refresh(const Graph& graph, int) override {
    roots_.clear();
    rootBegin_.assign(1, 0);
    parameters_.clear();
    for (int i = 0; i < size(); ++i) {
      const auto information = typed(i).informationStore().values();
      roots_.resize(roots_.size() + information.size());
      squareRoot(information, typed(i).informationStore().dimension(), roots_.data() + rootBegin_.back());
      rootBegin_.push_back(roots_.size());
      for (const std::int64_t id : edge(i).parameterIds()) {
        const std::span<const double> values = parameterValues(graph, id);
        parameters_.insert(parameters_.end(), values.begin(), values.end());
      }
    }
    kernels_.collect(size(), [this](int i) -> const RobustKernel& { return edge(i).robustKernel(); });
  }

 private:
  using VertexTypes = typename E::VertexTypes;
  template <int I>
  using Role = DynamicRole<std::tuple_element_t<static_cast<std::size_t>(I), VertexTypes>>;

  const E& typed(int i) const { return static_cast<const E&>(edge(i)); }
  std::size_t first(int i) const { return static_cast<std::size_t>(slots(i).data() - slots(0).data()); }

  /// Tangent dimension of the vertex at a place of the edge whose estimate has `count` numbers.
  static int dimensionAt(int place, int count) {
    int result = 0;
    [&]<int... I>(std::integer_sequence<int, I...>) {
      ((std::min(place, Calls::roles - 1) == I
            ? void(result = Role<I>::Vertex::dimension == Dynamic ? count : Role<I>::Vertex::dimension)
            : void()),
       ...);
    }
    (std::make_integer_sequence<int, Calls::roles>());
    return result;
  }

  template <typename S>
  typename Calls::template ParameterValues<S> parametersOf(int i) const {
    return [&]<typename... P>(ParameterList<P...>*) {
      const double* next = parameters_.data() + static_cast<std::size_t>(i) * Calls::constants;
      [[maybe_unused]] const auto take = [&next]<typename Value>(Value*) {
        S numbers[Packing<Value>::size];
        for (int k = 0; k < Packing<Value>::size; ++k) numbers[k] = S(*next++);
        return Packing<Value>::template load<S>(numbers);
      };
      return typename Calls::template ParameterValues<S>{take(static_cast<typename P::Value*>(nullptr))...};
    }(static_cast<typename E::Parameters*>(nullptr));
  }

  /// Estimates of edge i in scalar S; `seed` makes dual directions [seed, seed + chunk) of the edge's tangent, numbered
  /// through its roles.
  template <typename S>
  typename Calls::template Values<S> valuesOf(const State& state, int i, int seed = 0) const {
    typename Calls::template Values<S> values;
    std::size_t k = first(i);
    const std::size_t end = k + slots(i).size();
    int direction = 0;
    [&]<int... I>(std::integer_sequence<int, I...>) {
      (
          [&] {
            using Vertex = typename Role<I>::Vertex;
            const std::size_t last = Role<I>::any ? end : k + 1;
            for (; k < last; ++k) {
              const int count = counts_[k];
              std::vector<S> numbers(state.data() + records_[k], state.data() + records_[k] + count);
              auto x = DynamicEstimate<typename Vertex::Estimate, S>::fromNumbers(numbers.data(), count);
              if constexpr (!std::is_same_v<S, double>) {
                const int dimension = Vertex::dimension == Dynamic ? count : Vertex::dimension;
                Vector<S, Vertex::dimension> delta(dimension);
                for (int c = 0; c < dimension; ++c, ++direction) {
                  delta[c] = S(0.0);
                  if (direction >= seed && direction < seed + chunk) delta[c].gradient[direction - seed] = 1.0;
                }
                x = Vertex::oplus(x, delta);
              }
              std::get<I>(values).push_back(x);
            }
          }(),
          ...);
    }
    (std::make_integer_sequence<int, Calls::roles>());
    return values;
  }

  void run(const State& state, std::span<const std::int32_t> edges, const Panel& panel, bool withJacobians) const {
    if (edges.empty()) return;
    const int i = edges[0];
    if (const StopCondition* stop = stopOfCostlyEdges()) stop->throwIfReached();
    const EdgeShape shape = this->shape(i);
    std::vector<Matrix<double, Dynamic, Dynamic>> J;
    for (const int columns : shape.columns) J.emplace_back(shape.rows, columns);
    const typename Calls::template Values<double> x = valuesOf<double>(state, i);
    Vector<double, Dynamic> error =
        Calls::template error<double>(typed(i), typed(i).measurement(), parametersOf<double>(i), x);
    if (withJacobians) differentiate(state, i, shape, x, error, J);
    const double* U = roots_.data() + rootBegin_[static_cast<std::size_t>(i)];
    whitenColumn(U, shape.rows, error);
    panel.squaredError[0] = error.squaredNorm();
    for (int r = 0; r < shape.rows; ++r) panel.residual[r * Panel::lanes] = error[r];
    for (std::size_t role = 0; withJacobians && role < J.size(); ++role) {
      for (int c = 0; c < J[role].cols(); ++c) {
        whitenColumn(U, shape.rows, J[role].col(c));
        for (int r = 0; r < shape.rows; ++r) panel.jacobian[role][(c * shape.rows + r) * Panel::lanes] = J[role](r, c);
      }
    }
    const auto correction = withJacobians ? std::optional(robustCorrection()) : std::nullopt;
    applyKernels(panel, kernels_, edges, shape.rows, shape.columns, correction);
  }

  template <typename Column>
  static void whitenColumn(const double* U, int rows, Column&& column) {
    for (int r = 0, k = 0; r < rows; k += rows - r, ++r) {
      double sum = 0.0;
      for (int c = r; c < rows; ++c) sum += U[k + c - r] * column[c];
      column[r] = sum;
    }
  }

  void differentiate(const State& state, int i, const EdgeShape& shape,
                     const typename Calls::template Values<double>& x,
                     [[maybe_unused]] const Vector<double, Dynamic>& error,
                     std::vector<Matrix<double, Dynamic, Dynamic>>& J) const {
    if constexpr (form == Jacobians::analytic) {
      typename Calls::BlockLists blocks;
      std::size_t place = 0;
      [&]<int... I>(std::integer_sequence<int, I...>) {
        ((forEachOf<I>(x,
                       [&](std::size_t) {
                         std::get<I>(blocks).push_back(Matrix<double, Calls::rows, Role<I>::Vertex::dimension>::Zero(
                             shape.rows, shape.columns[place++]));
                       })),
         ...);
        Calls::jacobian(typed(i), typed(i).measurement(), parametersOf<double>(i), x, blocks);
        place = 0;
        ((forEachOf<I>(x,
                       [&](std::size_t k) {
                         const auto& block = std::get<I>(blocks)[k];
                         requireBlockSize(typed(i), typeName<E>(), block.rows(), block.cols(), shape.rows,
                                          shape.columns[place]);
                         J[place++] = block;
                       })),
         ...);
      }
      (std::make_integer_sequence<int, Calls::roles>());
    } else if constexpr (form == Jacobians::dual) {
      int total = 0;
      for (const int columns : shape.columns) total += columns;
      for (int seed = 0; seed < total; seed += chunk) {
        typename Calls::template MeasurementOf<DualChunk> m = measurementOf<DualChunk>(i);
        scatterGradients(Calls::template error<DualChunk>(typed(i), m, parametersOf<DualChunk>(i),
                                                          valuesOf<DualChunk>(state, i, seed)),
                         seed, shape, J);
      }
    } else {
      differences(i, error, x, J);
    }
  }

  template <int I, typename Visit>
  static void forEachOf(const typename Calls::template Values<double>& x, Visit visit) {
    for (std::size_t k = 0; k < std::get<I>(x).size(); ++k) visit(k);
  }

  template <typename S>
  typename Calls::template MeasurementOf<S> measurementOf(int i) const {
    if constexpr (Packable<typename E::Measurement>) {
      constexpr int size = Packing<typename E::Measurement>::size;
      S numbers[size];
      for (int k = 0; k < size; ++k) numbers[k] = S(typed(i).measurementStore().values()[k]);
      return Packing<typename E::Measurement>::template load<S>(numbers);
    } else {
      return typed(i).measurement();
    }
  }

  template <typename Error>
  static void scatterGradients(const Error& error, int seed, const EdgeShape& shape,
                               std::vector<Matrix<double, Dynamic, Dynamic>>& J) {
    int direction = 0;
    for (std::size_t role = 0; role < J.size(); ++role) {
      for (int c = 0; c < shape.columns[role]; ++c, ++direction) {
        if (direction < seed || direction >= seed + chunk) continue;
        for (int r = 0; r < shape.rows; ++r) J[role](r, c) = error[r].gradient[direction - seed];
      }
    }
  }

  void differences(int i, const Vector<double, Dynamic>& error, typename Calls::template Values<double> x,
                   std::vector<Matrix<double, Dynamic, Dynamic>>& J) const {
    const auto p = parametersOf<double>(i);
    const auto m = typed(i).measurement();
    std::size_t place = 0;
    [&]<int... I>(std::integer_sequence<int, I...>) {
      (
          [&] {
            using Vertex = typename Role<I>::Vertex;
            for (auto& estimate : std::get<I>(x)) {
              const auto original = estimate;
              Vector<double, Vertex::dimension> delta = Vector<double, Vertex::dimension>::Zero(J[place].cols());
              for (int c = 0; c < J[place].cols(); ++c) {
                const auto errorAt = [&](double step) -> Vector<double, Dynamic> {
                  delta[c] = step;
                  estimate = Vertex::oplus(original, delta);
                  return Calls::template error<double>(typed(i), m, p, x);
                };
                differentiateColumn(firstDifferenceStep<Vertex>(original, c), error, errorAt, J[place].col(c));
                delta[c] = 0.0;
                estimate = original;
              }
              ++place;
            }
          }(),
          ...);
    }
    (std::make_integer_sequence<int, Calls::roles>());
  }

  std::vector<std::int64_t> records_;
  std::vector<int> counts_;
  EdgeShape largest_;
  std::vector<double> roots_;
  std::vector<std::size_t> rootBegin_;
  std::vector<double> parameters_;
  BatchKernels kernels_;
};
}  // namespace quiver::detail
