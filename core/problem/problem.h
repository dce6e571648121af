#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/core/graph/graph.h>
#include <quiver/core/problem/edge_batch.h>
#include <quiver/core/problem/state.h>

namespace quiver {

/// Which part of a graph is compiled.
struct ProblemScope {
  /// Edges of this level; −1 means all.
  int level = 0;
  /// If not empty: only these vertices move, and only edges on them take part.
  std::vector<std::int64_t> free;
  int threads = 1;
};

/// Tangent directions of a variable, by bits, that are held.
struct HeldDirections {
  int variable = -1;
  std::uint64_t directions = 0;
};

/// What is solved: slots, free vertices, edges by type, two buffers of estimates. Compiled from a graph, which must
/// outlive it and must not lose elements meanwhile.
///
/// Everything is in a canonical order: types by tag, vertices of a type by id, edges of a type by their ids and then by
/// content; so the order in which a graph was built or a file was written does not reach the numbers. A slot is a
/// vertex that some active edge touches. A variable is a slot that may move; variables are numbered in the order of
/// slots.
class Problem {
 public:
  /// O(vertices + edges) when the graph is in canonical order already, else with a sort. Throws GraphError if a vertex
  /// has no estimate.
  Problem(Graph& graph, const ProblemScope& scope);

  const Graph& graph() const { return *graph_; }
  int threads() const { return threads_; }

  int slots() const { return layout_.slots(); }
  const Vertex& vertex(int slot) const { return *vertices_[static_cast<std::size_t>(slot)]; }
  const VertexType& vertexType(int slot) const { return graph_->typeOf(vertex(slot)); }
  const StateLayout& layout() const { return layout_; }

  int variables() const { return static_cast<int>(variableSlots_.size()); }
  /// −1 if the slot is fixed.
  int variableOfSlot(int slot) const { return slotVariables_[static_cast<std::size_t>(slot)]; }
  int slotOfVariable(int variable) const { return variableSlots_[static_cast<std::size_t>(variable)]; }
  int dimension(int variable) const { return dimensions_[static_cast<std::size_t>(variable)]; }
  std::span<const int> dimensions() const { return dimensions_; }
  /// First scalar of a variable in vectors over all variables.
  std::int64_t offset(int variable) const { return offsets_[static_cast<std::size_t>(variable)]; }
  std::int64_t scalars() const { return offsets_.back(); }
  /// Bits of tangent directions that are held; 0 for most.
  std::uint64_t heldDirections(int variable) const { return held_[static_cast<std::size_t>(variable)]; }
  bool anyHeldDirections() const { return anyHeld_; }

  /// Holds directions of variables beside those that their vertices hold, before a linear system is analysed. A
  /// variable all of whose directions are held becomes a constant.
  void holdDirections(std::span<const HeldDirections> holds);
  /// Takes back all that holdDirections held.
  void releaseDirections() { numberVariables(movable_); }

  /// Variables of one type and dimension that are neighbours.
  struct Run {
    const VertexType* type;
    int begin;
    int end;
  };
  std::span<const Run> runs() const { return runs_; }

  int batches() const { return static_cast<int>(batches_.size()); }
  const EdgeBatch& batch(int i) const { return *batches_[static_cast<std::size_t>(i)]; }
  const EdgeType& edgeType(int batch) const { return *edgeTypes_[static_cast<std::size_t>(batch)]; }
  std::int64_t edges() const { return edges_; }
  /// Free vertices that no active edge touches: left as they are.
  std::span<const std::int64_t> isolated() const { return isolated_; }

  const State& state() const { return state_; }
  const State& trial() const { return trial_; }
  /// Lengths over all variables: ‖δ‖, and ‖x‖ of the values it moves.
  struct StepLengths {
    double step;
    double state;
  };
  /// trial = state ⊞ delta, delta over all variables.
  StepLengths retract(std::span<const double> delta);
  /// The trial becomes the state, and the old state the next trial.
  void acceptTrial() { std::swap(state_, trial_); }
  /// Keeps a copy of the state, or brings it back.
  void saveBest();
  void restoreBest() { state_ = best_; }

  /// Σ eᵀΩe and Σ ρ at a state, in a fixed order of additions. Allocates nothing after the first call.
  CostTotals evaluate(const State& state);

  /// Costly edges throw WorkStopped out of evaluations and linearisations once `stop` is reached; nullptr ends that.
  void setStop(const StopCondition* stop);

  /// Reads estimates from the graph again and, unless nothing else has changed there, measurements and weights; its
  /// structure must be that of the compilation.
  void refresh(bool estimatesOnly = false);
  /// How robust kernels enter linearisations from now on; first order unless set.
  void setRobustCorrection(RobustCorrection correction);
  /// Writes the state's estimates of all variables to the graph.
  void store();

 private:
  /// Edges, and the slots of their vertices one edge after the other, by edge type.
  using EdgeLists = std::vector<std::vector<const Edge*>>;
  using SlotLists = std::vector<std::vector<std::int32_t>>;

  EdgeLists collectEdges(const ProblemScope& scope) const;
  /// Fills vertices_.
  SlotLists findSlots(const ProblemScope& scope, const EdgeLists& edges);
  SlotLists collectVertices(const ProblemScope& scope, const EdgeLists& edges);
  void makeBatches(EdgeLists edges, SlotLists ends);
  void numberVariables(const std::vector<char>& movable);
  void loadState();
  void measureRowCosts();
  void makePanels();

  Graph* graph_;
  int threads_;
  int evaluationThreads_ = 1;
  std::vector<Vertex*> vertices_;
  StateLayout layout_;
  std::vector<char> movable_;  // by slot, before anything is held
  std::vector<int> slotVariables_;
  std::vector<int> variableSlots_;
  std::vector<int> dimensions_;
  std::vector<std::int64_t> offsets_ = {0};
  std::vector<std::uint64_t> held_;
  bool anyHeld_ = false;
  std::vector<std::unique_ptr<EdgeBatch>> batches_;
  std::vector<const EdgeType*> edgeTypes_;
  std::int64_t edges_ = 0;
  std::vector<std::int64_t> isolated_;
  /// Σ x² over the values of variables begin … end − 1.
  double squaredValues(int begin, int end) const;

  std::vector<Run> runs_;
  std::vector<StepLengths> squares_;  // of pieces that are moved together
  std::vector<std::int64_t> records_;
  State state_;
  State trial_;
  State best_;

  /// Pieces of a batch's edges with their partial sums, and the panels of the tasks that evaluate them.
  struct Piece {
    int batch;
    int begin;
    int end;
    CostTotals totals;
  };
  std::vector<Piece> pieces_;
  std::vector<std::vector<PanelBuffer>> panels_;
};

}  // namespace quiver
