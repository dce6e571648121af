#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <quiver/core/graph/edge.h>
#include <quiver/core/problem/edge_rows.h>
#include <quiver/core/problem/panel.h>
#include <quiver/core/problem/product_targets.h>
#include <quiver/core/problem/state.h>
#include <quiver/core/util/stop_condition.h>

namespace quiver {

class Graph;

namespace detail {
// Access to a graph for templates that its header cannot include.
Vertex& vertexOf(Graph& graph, std::int64_t id);
const Parameter& parameterOf(const Graph& graph, std::int64_t id);
std::span<const double> parameterValues(const Graph& graph, std::int64_t id);
}  // namespace detail

/// What a batch is compiled from: edges of one type, in the problem's canonical order, and the slots of their vertices.
struct BatchSource {
  const Graph& graph;
  const StateLayout& layout;
  std::vector<const Edge*> edges;
  /// One edge after the other. If all edges have one arity, `begin` is empty; else the slots of edge i are
  /// slots[begin[i]] … slots[begin[i + 1] − 1].
  std::vector<std::int32_t> slots;
  std::vector<std::int64_t> begin;
  /// Threads that compiling may use.
  int threads = 1;
};

/// Nanoseconds that a row of an error takes, about. It decides about threads and about how often a stop is looked for,
/// never about results.
struct RowCost {
  double evaluate = 3.0;
  double linearize = 12.0;
};

/// All active edges of one type, compiled: the boundary between types and solvers.
///
/// The solver decides which edges are evaluated, in which order, and what becomes of the panel; a batch never sees a
/// matrix. Edges are numbered from 0 in the batch. Const functions may be called from several threads at once with
/// different panels. What is computed for an edge does not depend on the other edges of the list nor on its place in
/// it: the same bits always.
class EdgeBatch {
 public:
  virtual ~EdgeBatch() = default;

  int size() const { return static_cast<int>(edges_.size()); }
  const Edge& edge(int i) const { return *edges_[static_cast<std::size_t>(i)]; }
  std::span<const std::int32_t> slots(int i) const {
    if (begin_.empty()) return {slots_.data() + static_cast<std::size_t>(i) * arity_, arity_};
    return {slots_.data() + begin_[static_cast<std::size_t>(i)],
            slots_.data() + begin_[static_cast<std::size_t>(i) + 1]};
  }
  /// Whether all edges have the shape `largestShape()`. If not, lists may hold one edge only.
  virtual bool uniform() const = 0;
  virtual EdgeShape shape(int edge) const = 0;
  /// The largest rows and columns of any edge: the shape for a PanelBuffer.
  virtual EdgeShape largestShape() const = 0;

  /// Residuals, squared errors, costs and weights of at most 64 edges at `state`. Residuals are whitened, not yet
  /// weighted.
  virtual void evaluate(const State& state, std::span<const std::int32_t> edges, const Panel& panel) const = 0;
  /// The same and the Jacobian blocks, with residuals and blocks weighted by the robust kernels.
  virtual void linearize(const State& state, std::span<const std::int32_t> edges, const Panel& panel) const = 0;

  /// Whether addProducts may be called: the type runs in lanes, its products fit the loop, and no edge has a robust
  /// kernel. May change with refresh().
  virtual bool addsProducts() const { return false; }
  /// Linearises edges first … first + count − 1 and adds the products of their blocks to `targets`, which saves a
  /// panel's way through memory. `first` is a multiple of eight, and so is `count` unless the last edge is among them.
  /// squaredError[i] is eᵀΩe of edge first + i; it has room for whole groups of eight.
  virtual void addProducts(const State&, int /*first*/, int /*count*/, const ProductTargets&,
                           double* /*squaredError*/) const {}

  /// Bytes of a row of eight edges that are laid out in rows; 0 if the batch does not do so, as its type does not run
  /// in lanes.
  virtual std::int64_t rowBytes() const { return 0; }
  /// Copies `edges`, a whole number of rows of eight, to `rows`.
  virtual void packRows(std::span<const std::int32_t> /*edges*/, EdgeRows& /*rows*/, int /*threads*/) const {}
  /// The same as evaluate and linearize, for the edges that lie from row `first` on; `edges` names them.
  virtual void evaluateRows(const State&, const EdgeRows&, std::int64_t /*first*/,
                            std::span<const std::int32_t> /*edges*/, const Panel&) const {}
  virtual void linearizeRows(const State&, const EdgeRows&, std::int64_t /*first*/,
                             std::span<const std::int32_t> /*edges*/, const Panel&) const {}
  /// Counts refreshes that found changes: rows of an older revision are to be packed again.
  std::int64_t revision() const { return revision_; }

  /// Reads measurements, information, parameters and kernels again from those of the same edges that have changed, and
  /// from those with parameters; the structure is unchanged.
  virtual void refresh(const Graph& graph, int threads) = 0;
  /// Whether any edge has a robust kernel.
  virtual bool robust() const = 0;

  /// How robust kernels enter `linearize` from now on; first order unless set.
  void setRobustCorrection(RobustCorrection correction) { correction_ = correction; }
  RobustCorrection robustCorrection() const { return correction_; }

  /// That of eight edges side by side unless measured.
  const RowCost& rowCost() const { return rowCost_; }
  void setRowCost(const RowCost& cost) { rowCost_ = cost; }
  /// Edges so costly that the clock does not count look at `stop` one by one and throw WorkStopped once it is reached;
  /// others leave that to the loops of whoever calls. nullptr, as it is at first, means never.
  void setStop(const StopCondition* stop) { stop_ = stop; }

 protected:
  /// Takes the lists out of the source.
  explicit EdgeBatch(BatchSource& source)
      : edges_(std::move(source.edges)),
        slots_(std::move(source.slots)),
        begin_(std::move(source.begin)),
        arity_(edges_.empty() ? 0 : slots_.size() / edges_.size()) {}
  const Edge* const* edges() const { return edges_.data(); }
  void countRefresh() { ++revision_; }
  const StopCondition* stopOfCostlyEdges() const {
    constexpr double costly = 200.0;
    return rowCost_.evaluate > costly ? stop_ : nullptr;
  }

 private:
  std::vector<const Edge*> edges_;
  std::vector<std::int32_t> slots_;
  std::vector<std::int64_t> begin_;
  std::size_t arity_;
  RobustCorrection correction_ = RobustCorrection::first;
  RowCost rowCost_;
  const StopCondition* stop_ = nullptr;
  std::int64_t revision_ = 0;
};

}  // namespace quiver
