#pragma once

#include <memory>
#include <vector>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/solvers/assembly/assembler.h>
#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// The linear system of all variables at once: H in the solver's elimination order, assembled from panels, factored by
/// a linear solver.
class NormalEquations final : public LinearSystem {
 public:
  explicit NormalEquations(std::unique_ptr<LinearSolver> solver);
  /// The solver chosen by predicted cost when the structure is known.
  NormalEquations();

  void analyze(const Problem& problem, const Options& options, int threads) override;
  void restart() override { solver_->restart(); }
  CostTotals linearize(const State& state) override;
  std::optional<CostTotals> tryState(const State& trial) override;
  void dropTrial() override;
  LinearOutcome solve(std::span<const double> damping, std::span<double> delta, const StopCondition& stop) override;
  LinearOutcome solveWithLastFactor(std::span<double> delta, const StopCondition& stop) override;
  bool applyInverse(std::span<double> b) override;
  std::span<const double> gradient() const override { return gradient_; }
  std::span<const double> diagonal() const override { return diagonal_; }
  void multiply(std::span<const double> x, std::span<double> y) const override;
  const SolvePlan& plan() const override { return plan_; }
  void addSeconds(PhaseSeconds& seconds) override;

 private:
  LinearOutcome outcomeOf(const SolverStatus& status) const;
  /// blockVector_ = −g.
  void loadGradient();
  void chooseSolver(const BlockPattern& pattern);
  /// Copies between the order of variables and that of blocks.
  /// Calls copy(first scalar of a variable, first scalar of its block, dimension) for every block; usual dimensions
  /// that all have in common are constants of the type.
  template <typename Copy>
  void forEachBlock(const Copy& copy) const;
  void toBlocks(std::span<const double> variables, std::span<double> blocks) const;
  void toVariables(std::span<const double> blocks, std::span<double> variables) const;

  const Problem* problem_ = nullptr;
  std::unique_ptr<LinearSolver> solver_;
  bool choose_ = false;
  BlockMatrix matrix_;
  Assembler assembler_;
  std::vector<int> order_;  // order_[block] = variable
  int alike_ = 0;           // the dimension of all variables, 0 if they differ
  std::vector<double> gradient_;
  std::vector<double> diagonal_;
  std::vector<double> blockDamping_;
  mutable std::vector<double> blockVector_;
  mutable std::vector<double> blockResult_;
  /// The state of the last linearize(), and what a trial since then overwrote: its state and totals, or null.
  const State* state_ = nullptr;
  const double* tried_ = nullptr;
  CostTotals triedTotals_;
  SolvePlan plan_;
  PhaseSeconds seconds_;
};

}  // namespace quiver
