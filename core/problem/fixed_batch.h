#pragma once

#include <memory>
#include <vector>

#include <quiver/core/problem/apply_kernels.h>
#include <quiver/core/problem/edge_batch.h>
#include <quiver/core/problem/pack_rows.h>
#include <quiver/core/problem/product_loop.h>
#include <quiver/core/problem/scalar_loop.h>
#include <quiver/core/problem/square_root.h>
#include <quiver/core/util/aligned_buffer.h>
#include <quiver/core/util/parallel.h>
#include <quiver/geometry/scalar/isa.h>

namespace quiver::detail {

/// The form of an edge type's Jacobians and whether it runs in lanes: decided at compile time by what the type offers.
template <typename E>
struct EdgeFormOf {
  using Functions = EdgeFunctions<E>;
  using Loop = EdgeLoop<E>;
  using Lane = Lanes<isa::Avx512>;
  template <typename S>
  using DualOf = Dual<S, Loop::tangent>;
  static constexpr Jacobians requested = requestedJacobians<E>();

  static constexpr bool hasAnalytic = Functions::template anyJacobian<double>;
  static constexpr bool hasDual =
      Functions::template anyError<DualOf<double>> && Functions::template retracts<DualOf<double>>;
  static_assert(Functions::template anyError<double>,
                "computeError must take (measurement, parameters…, estimates…) and return exactly Vector<double, N>; "
                "`auto` would return an expression of what is gone by then");
  static_assert(requested != Jacobians::analytic || hasAnalytic,
                "jacobians = analytic needs linearizeOplus(measurement, estimates…, Matrix<S, N, D>&…)");
  static_assert(requested != Jacobians::automatic || hasAnalytic || !namesJacobian<E>,
                "linearizeOplus is there, but does not take (measurement, parameters…, estimates…, Matrix<S, N, D>&…) "
                "with a block of N rows and D columns for every vertex");
  static_assert(
      requested != Jacobians::dual || hasDual,
      "jacobians = dual needs computeError and the vertices' oplus as templates that return exactly Vector<S, N>");

  static constexpr Jacobians jacobians =
      requested != Jacobians::automatic
          ? requested
          : (hasAnalytic ? Jacobians::analytic : (hasDual ? Jacobians::dual : Jacobians::numeric));

  static constexpr bool laneError = Functions::packableMeasurement && Functions::template staticError<Lane>;
  static constexpr bool laneJacobian =
      jacobians == Jacobians::analytic
          ? Functions::template staticJacobian<Lane>
          : (jacobians == Jacobians::dual && Functions::template staticError<DualOf<Lane>> &&
             Functions::template retracts<DualOf<Lane>>);
  static_assert(!requestsLanes<E>() || laneError,
                "lanes = true needs a static template computeError<S> that returns exactly Vector<S, N> and a packable "
                "measurement");
  static constexpr bool lanes = requestsLanes<E>() && laneError && laneJacobian;

  static EdgeForm describe() {
    EdgeForm form;
    form.jacobians = jacobians;
    form.lanes = lanes;
    if (requested != Jacobians::automatic) {
      form.reason = "the type insists";
    } else if (jacobians == Jacobians::analytic) {
      form.reason = "the type has linearizeOplus";
    } else if (jacobians == Jacobians::dual) {
      form.reason = "computeError takes dual numbers";
    } else {
      form.reason =
          "neither linearizeOplus nor a computeError and oplus that take dual numbers and return exactly Vector<S, N>";
    }
    if (requestsLanes<E>() && !lanes) form.reason += "; one edge at a time, since the Jacobian does not take lanes";
    return form;
  }
};

/// A batch of an edge type whose shape is known at compile time.
template <typename E>
class FixedBatch final : public EdgeBatch {
  using Loop = EdgeLoop<E>;
  using Form = EdgeFormOf<E>;
  static constexpr bool multiplies = Form::lanes && multipliesInLoop<E>();

 public:
  explicit FixedBatch(BatchSource& source) : EdgeBatch(source), instructionSet_(detectInstructionSet()) {
    const std::int64_t count = size();
    records_.resize(static_cast<std::size_t>(count * Loop::arity));
    for (std::int64_t i = 0; i < count; ++i) {
      const auto slots = this->slots(static_cast<int>(i));
      for (int role = 0; role < Loop::arity; ++role) {
        records_[static_cast<std::size_t>(role * count + i)] =
            source.layout.offset(slots[static_cast<std::size_t>(role)]);
      }
    }
    refresh(source.graph, source.threads);
  }

  bool uniform() const override { return true; }
  EdgeShape shape(int) const override { return largestShape(); }
  EdgeShape largestShape() const override { return {Loop::rows, {std::begin(Loop::columns), std::end(Loop::columns)}}; }

  void evaluate(const State& state, std::span<const std::int32_t> edges, const Panel& panel) const override {
    run<false>(view(state), edges.data(), static_cast<int>(edges.size()), panel);
    applyKernels(panel, kernels_, edges, Loop::rows, {}, std::nullopt);
  }

  void linearize(const State& state, std::span<const std::int32_t> edges, const Panel& panel) const override {
    run<true>(view(state), edges.data(), static_cast<int>(edges.size()), panel);
    applyKernels(panel, kernels_, edges, Loop::rows, Loop::columns, robustCorrection());
  }

  bool addsProducts() const override { return multiplies && inLanes() && kernels_.none(); }

  void addProducts(const State& state, int first, int count, const ProductTargets& targets,
                   double* squaredError) const override {
    if constexpr (multiplies) {
      if constexpr (QUIVER_EVERY_INSTRUCTION_SET) {
        if (instructionSet_ == InstructionSet::avx512)
          return productsAvx512(view(state), first, count, targets, squaredError);
      }
      productsAvx2(view(state), first, count, targets, squaredError);
    }
  }

  std::int64_t rowBytes() const override {
    return inLanes() ? Panel::lanes * (std::int64_t{8} * numbers_ + std::int64_t{4} * Loop::arity) : 0;
  }

  void packRows(std::span<const std::int32_t> edges, EdgeRows& rows, int threads) const override {
    detail::packRows(view(State()), Loop::arity, edges, rows, threads);
    rows.revision = revision();
  }

  void evaluateRows(const State& state, const EdgeRows& rows, std::int64_t first, std::span<const std::int32_t> edges,
                    const Panel& panel) const override {
    run<false>(view(state, rows, first), edges.data(), static_cast<int>(edges.size()), panel);
    applyKernels(panel, kernels_, edges, Loop::rows, {}, std::nullopt);
  }

  void linearizeRows(const State& state, const EdgeRows& rows, std::int64_t first, std::span<const std::int32_t> edges,
                     const Panel& panel) const override {
    run<true>(view(state, rows, first), edges.data(), static_cast<int>(edges.size()), panel);
    applyKernels(panel, kernels_, edges, Loop::rows, Loop::columns, robustCorrection());
  }

  bool robust() const override { return !kernels_.none(); }

  void refresh(const Graph& graph, int threads) override {
    if (changes_.empty()) {
      whitening_ = whiteningOf(information(0), Loop::rows);  // mostly all edges are like the first
      changes_.assign(static_cast<std::size_t>(size()), ~std::uint64_t{0});
      layOut();
    }
    constexpr double looking = 6.0, packing = 40.0;  // nanoseconds an edge, about
    const bool first = revision() == 0;
    const Found found = packChanged(graph, worthwhileThreads(threads, (first ? packing : looking) * size()));
    if (found.whitening > whitening_) {
      whitening_ = found.whitening;
      changes_.assign(changes_.size(), ~std::uint64_t{0});
      layOut();
      packChanged(graph, worthwhileThreads(threads, packing * size()));
    }
    if (!found.changed) return;
    countRefresh();
    kernels_.collect(size(), [this](int i) -> const RobustKernel& { return edge(i).robustKernel(); });
  }

 private:
  BatchView view(const State& state) const {
    return {constants_.data(), numbers_, records_.data(),    size(), state.data(), whitening_,
            edges(),           nullptr,  stopOfCostlyEdges()};
  }
  BatchView view(const State& state, const EdgeRows& rows, std::int64_t first) const {
    BatchView result = view(state);
    result.constants = rows.constants.data() + first * numbers_ * Panel::lanes;
    result.rows = rows.records.data() + first * Loop::arity * Panel::lanes;
    return result;
  }

  std::span<const double> information(int i) const {
    return static_cast<const E&>(edge(i)).informationStore().values();
  }

  void layOut() {
    numbers_ = Loop::values + whiteningNumbers(whitening_, Loop::rows);
    const std::int64_t padded = (std::int64_t{size()} + Panel::lanes - 1) / Panel::lanes * Panel::lanes;
    if (constants_.size() != padded * numbers_) constants_ = AlignedBuffer(padded * numbers_, false);
  }

  /// Whether any edge had changed, and the most general whitening of those.
  struct Found {
    bool changed = false;
    Whitening whitening = Whitening::none;
  };

  /// Writes the constants of edges that have changed or have parameters.
  Found packChanged(const Graph& graph, int threads) {
    constexpr int chunk = 256;
    const int count = size();
    found_.assign(static_cast<std::size_t>((count + chunk - 1) / chunk), {});
    parallelFor(static_cast<std::int64_t>(found_.size()), threads, [&](std::int64_t c) {
      Found& found = found_[static_cast<std::size_t>(c)];
      const int end = std::min(count, static_cast<int>(c + 1) * chunk);
      for (int i = static_cast<int>(c) * chunk; i < end; ++i) {
        std::uint64_t& known = changes_[static_cast<std::size_t>(i)];
        const std::uint64_t now = edge(i).changes();
        if (known == now && E::Parameters::size == 0) continue;
        known = now;
        found.changed = true;
        found.whitening = std::max(found.whitening, whiteningOf(information(i), Loop::rows));
        if (inLanes()) {
          pack<Panel::lanes>(graph, i);
        } else {
          pack<1>(graph, i);
        }
      }
    });
    Found all;
    for (const Found& found : found_) {
      all.changed = all.changed || found.changed;
      all.whitening = std::max(all.whitening, found.whitening);
    }
    return all;
  }

  /// Lays out the constants of one edge, `step` edges side by side. The last edge also fills the lanes behind it.
  template <int step>
  void pack(const Graph& graph, int i) {
    const E& edge = static_cast<const E&>(this->edge(i));
    double* const first = constants_.data() + std::int64_t{i} / step * step * numbers_ + i % step;
    double* next = first;
    const auto put = [&](double number) {
      *next = number;
      next += step;
    };
    if constexpr (Packable<typename E::Measurement>) {
      const double* const measurement = edge.measurementStore().values();
      for (int k = 0; k < Loop::measurementSize; ++k) put(measurement[k]);
    }
    if constexpr (E::Parameters::size > 0) {
      for (const std::int64_t id : edge.parameterIds()) {
        for (const double value : parameterValues(graph, id)) put(value);
      }
    }
    if (whitening_ == Whitening::diagonal) {
      for (int r = 0, k = 0; r < Loop::rows; k += Loop::rows - r, ++r)
        put(std::sqrt(std::max(information(i)[static_cast<std::size_t>(k)], 0.0)));
    } else if (whitening_ == Whitening::triangular) {
      double root[Loop::triangle];
      squareRoot(information(i), Loop::rows, root);
      for (const double number : root) put(number);
    }
    for (int lane = i + 1; i + 1 == size() && lane % step != 0; ++lane) {
      for (int k = 0; k < numbers_; ++k) first[k * step + lane - i] = first[k * step];
    }
  }

  /// Without vector registers eight edges at a time cost more than one.
  bool inLanes() const { return Form::lanes && instructionSet_ != InstructionSet::generic; }

  template <bool withJacobians>
  void run(const BatchView& view, const std::int32_t* edges, int count, const Panel& panel) const {
    if constexpr (Form::lanes) {
      if constexpr (QUIVER_EVERY_INSTRUCTION_SET) {
        if (instructionSet_ == InstructionSet::avx512) return lanesAvx512<withJacobians>(view, edges, count, panel);
      }
      if (instructionSet_ != InstructionSet::generic) return lanesAvx2<withJacobians>(view, edges, count, panel);
    } else if constexpr (QUIVER_EVERY_INSTRUCTION_SET) {
      if (instructionSet_ != InstructionSet::generic) return scalarAvx2<withJacobians>(view, edges, count, panel);
    }
    scalarGeneric<withJacobians>(view, edges, count, panel);
  }

  template <bool withJacobians>
  QUIVER_BATCH_LOOP_AVX512 static void lanesAvx512(const BatchView& view, const std::int32_t* edges, int count,
                                                   const Panel& panel) {
    laneLoop<E, Lanes<isa::Avx512>, Form::jacobians == Jacobians::analytic, withJacobians>(view, edges, count, panel);
  }
  template <bool withJacobians>
  QUIVER_BATCH_LOOP_AVX2 static void lanesAvx2(const BatchView& view, const std::int32_t* edges, int count,
                                               const Panel& panel) {
    laneLoop<E, Lanes<isa::Avx2>, Form::jacobians == Jacobians::analytic, withJacobians>(view, edges, count, panel);
  }
  QUIVER_BATCH_LOOP_AVX512 static void productsAvx512(const BatchView& view, int first, int count,
                                                      const ProductTargets& targets, double* squaredError) {
    productLoop<E, Lanes<isa::Avx512>, Form::jacobians == Jacobians::analytic>(view, first, count, targets,
                                                                               squaredError);
  }
  QUIVER_BATCH_LOOP_AVX2 static void productsAvx2(const BatchView& view, int first, int count,
                                                  const ProductTargets& targets, double* squaredError) {
    productLoop<E, Lanes<isa::Avx2>, Form::jacobians == Jacobians::analytic>(view, first, count, targets, squaredError);
  }
  template <bool withJacobians>
  QUIVER_BATCH_LOOP_AVX2 static void scalarAvx2(const BatchView& view, const std::int32_t* edges, int count,
                                                const Panel& panel) {
    scalarLoop<E, Form::jacobians, withJacobians>(view, edges, count, panel);
  }
  template <bool withJacobians>
  QUIVER_BATCH_LOOP_GENERIC static void scalarGeneric(const BatchView& view, const std::int32_t* edges, int count,
                                                      const Panel& panel) {
    scalarLoop<E, Form::jacobians, withJacobians>(view, edges, count, panel);
  }

  InstructionSet instructionSet_;
  AlignedBuffer constants_;
  std::vector<std::int64_t> records_;
  BatchKernels kernels_;
  Whitening whitening_ = Whitening::triangular;
  int numbers_ = 0;
  /// By edge: Edge::changes() when it was packed. By chunk: what was found there.
  std::vector<std::uint64_t> changes_;
  std::vector<Found> found_;
};

}  // namespace quiver::detail
