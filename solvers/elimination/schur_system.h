#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/solvers/backends/linear_solver.h>
#include <quiver/solvers/elimination/clique_pattern.h>
#include <quiver/solvers/elimination/conjugate_reduction.h>
#include <quiver/solvers/elimination/elimination_choice.h>
#include <quiver/solvers/elimination/point_eliminator.h>
#include <quiver/solvers/elimination/power_series.h>

namespace quiver {

/// The linear system by elimination of an independent set of variables, block-diagonal in H: what is left, the Schur
/// complement S, is solved by a linear solver, then each eliminated variable by itself.
///
/// Where S would be large and sparse in products it is never formed: conjugate gradients multiply with it through the
/// edges, preconditioned with its diagonal blocks. Asked for the solver "power", a power series does.
///
/// Every pass over the edges linearises anew: `linearize` once for H's diagonal blocks and g, `solve` once for S and
/// once to substitute back. Eliminated variables whose block is singular are left as they are in the directions
/// concerned and named in plan().singular. The same bits for any number of threads with a solver that has them.
class SchurSystem final : public LinearSystem {
 public:
  /// `solver` factors S; null lets the system choose. `choice` overrides chooseElimination.
  explicit SchurSystem(std::unique_ptr<LinearSolver> solver = nullptr, std::optional<EliminationChoice> choice = {});

  void analyze(const Problem& problem, const Options& options, int threads) override;
  void restart() override;
  CostTotals linearize(const State& state) override;
  std::optional<CostTotals> tryState(const State& trial) override;
  void dropTrial() override { tried_ = nullptr; }
  LinearOutcome solve(std::span<const double> damping, std::span<double> delta, const StopCondition& stop) override;
  std::span<const double> gradient() const override { return gradient_; }
  std::span<const double> diagonal() const override { return diagonal_; }
  void multiply(std::span<const double> x, std::span<double> y) const override;
  const SolvePlan& plan() const override { return plan_; }
  void addSeconds(PhaseSeconds& seconds) override;

 private:
  void planReduced(const Options& options);
  void chooseSolver(const BlockPattern& pattern, const Options& options);
  std::int64_t predictBytes(int threads) const;
  void layOut(int threads);
  LinearOutcome solveReduced(std::span<double> delta, const StopCondition& stop);
  SolverStatus applyFactor(std::span<double> x);
  LinearOutcome outcomeOf(const SolverStatus& status) const;
  void nameSingular();

  const Problem* problem_ = nullptr;
  std::unique_ptr<LinearSolver> solver_;
  bool choose_ = false;
  bool implicit_ = false;
  ConjugateReduction conjugate_;
  bool sums_ = false;
  PowerSeries series_;
  std::optional<EliminationChoice> choice_;
  EliminationPlan elimination_;
  RowLinearizer linearizer_;
  PointAssembler assembler_;
  mutable PointEliminator eliminator_;
  PointNeighbours neighbours_;
  std::shared_ptr<const BlockPattern> pattern_;
  BlockMatrix matrix_;
  std::vector<int> order_;     // order_[block] = kept vertex
  std::vector<int> position_;  // position_[kept] = block
  std::vector<double> right_;
  std::vector<double> blockVector_;
  std::vector<double> gradient_;
  std::vector<double> diagonal_;
  const State* state_ = nullptr;
  /// Memory of the state that was tried last, null once it is taken, and the totals there.
  const double* tried_ = nullptr;
  CostTotals triedTotals_;
  bool surveyed_ = false;
  SolvePlan plan_;
  PhaseSeconds seconds_;
};

}  // namespace quiver
