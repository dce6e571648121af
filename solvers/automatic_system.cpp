#include <quiver/solvers/automatic_system.h>

#include <quiver/solvers/elimination/schur_system.h>
#include <quiver/solvers/normal_equations.h>
#include <quiver/solvers/single_variable.h>

namespace quiver {

AutomaticSystem::AutomaticSystem(std::function<std::unique_ptr<LinearSolver>()> make) : make_(std::move(make)) {}

bool AutomaticSystem::eliminates(const Problem& problem, const Options& options) const {
  if (single(problem, options)) return false;
  choice_ = chooseElimination(problem, options);
  choiceVariables_ = problem.variables();
  return choice_->count > 0;
}

bool AutomaticSystem::single(const Problem& problem, const Options& options) const {
  return !make_ && options.elimination != EliminationPolicy::types && SingleVariable::serves(problem);
}

void AutomaticSystem::analyze(const Problem& problem, const Options& options, int threads) {
  if (single(problem, options)) {
    system_ = std::make_unique<SingleVariable>();
    system_->analyze(problem, options, threads);
    plan_ = system_->plan();
    return;
  }
  // Variables that were fixed since make it another problem.
  EliminationChoice choice =
      choice_ && choiceVariables_ == problem.variables() ? std::move(*choice_) : chooseElimination(problem, options);
  choice_.reset();
  eliminates_ = choice.count > 0;
  const std::string reason = choice.reason;
  if (eliminates_) {
    system_ = std::make_unique<SchurSystem>(make_ ? make_() : nullptr, std::move(choice));
  } else {
    system_ = make_ ? std::make_unique<NormalEquations>(make_()) : std::make_unique<NormalEquations>();
  }
  system_->analyze(problem, options, threads);
  plan_ = system_->plan();
  plan_.eliminationReason = reason;
}

}  // namespace quiver
