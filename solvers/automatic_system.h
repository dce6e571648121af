#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/solvers/backends/linear_solver.h>
#include <quiver/solvers/elimination/elimination_choice.h>

namespace quiver {

/// Decides between one variable (SingleVariable), all variables at once (NormalEquations) and elimination of an
/// independent set first (SchurSystem) when the structure is known, as Options::elimination says; what is left is
/// solved by a given linear solver or by the one of least predicted cost.
class AutomaticSystem final : public LinearSystem {
 public:
  /// `make` is empty to have the linear solver chosen.
  explicit AutomaticSystem(std::function<std::unique_ptr<LinearSolver>()> make = {});

  bool eliminates(const Problem& problem, const Options& options) const override;
  void analyze(const Problem& problem, const Options& options, int threads) override;
  void restart() override { system_->restart(); }
  CostTotals linearize(const State& state) override { return system_->linearize(state); }
  std::optional<CostTotals> tryState(const State& trial) override { return system_->tryState(trial); }
  void dropTrial() override { system_->dropTrial(); }
  LinearOutcome solve(std::span<const double> damping, std::span<double> delta, const StopCondition& stop) override {
    return system_->solve(damping, delta, stop);
  }
  LinearOutcome solveWithLastFactor(std::span<double> delta, const StopCondition& stop) override {
    return system_->solveWithLastFactor(delta, stop);
  }
  bool applyInverse(std::span<double> b) override { return system_->applyInverse(b); }
  std::span<const double> gradient() const override { return system_->gradient(); }
  std::span<const double> diagonal() const override { return system_->diagonal(); }
  void multiply(std::span<const double> x, std::span<double> y) const override { system_->multiply(x, y); }
  const SolvePlan& plan() const override { return eliminates_ ? system_->plan() : plan_; }
  void addSeconds(PhaseSeconds& seconds) override { system_->addSeconds(seconds); }

 private:
  bool single(const Problem& problem, const Options& options) const;

  std::function<std::unique_ptr<LinearSolver>()> make_;
  std::unique_ptr<LinearSystem> system_;
  bool eliminates_ = false;
  SolvePlan plan_;
  /// What `eliminates` found, for `analyze`, and the number of variables it found it for.
  mutable std::optional<EliminationChoice> choice_;
  mutable int choiceVariables_ = 0;
};

}  // namespace quiver
