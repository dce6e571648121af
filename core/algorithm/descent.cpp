#include <quiver/core/algorithm/descent.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <quiver/core/algorithm/diagnosis.h>
#include <quiver/core/algorithm/gradient_size.h>
#include <quiver/core/algorithm/graph_watch.h>
#include <quiver/core/algorithm/short_steps.h>
#include <quiver/core/util/pieces.h>

namespace quiver {
namespace {

constexpr std::string_view interruptedReason = "interrupted; the best estimate so far is kept";

/// Squared standard deviations an edge: in statistics nothing.
constexpr double negligibleCost = 1e-6;

/// A formatted sentence that needs no heap unless it is long.
class ShortText {
 public:
  template <typename... Arguments>
  explicit ShortText(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }
  operator std::string_view() const { return {text_.data(), text_.size()}; }

 private:
  fmt::memory_buffer text_;
};

}  // namespace

Descent::Descent(Problem& problem, LinearSystem& system, const Options& options, const StopCondition& stop,
                 DescentMemory& memory, Summary& summary)
    : problem_(problem), system_(system), options_(options), stop_(stop), memory_(memory), summary_(summary) {
  memory_.delta.assign(static_cast<std::size_t>(problem.scalars()), 0.0);
}

std::vector<double>& Descent::scratch(int number) {
  std::vector<double>& numbers = memory_.scratch[static_cast<std::size_t>(number)];
  numbers.assign(memory_.delta.size(), 0.0);
  return numbers;
}

DampingScale& Descent::dampingScale() {
  if (!memory_.scale) memory_.scale.emplace(problem_);
  return *memory_.scale;
}

int Descent::vectorThreads() const {
  constexpr double nanosecondsPerNumber = 1.0;
  const auto scalars = static_cast<double>(problem_.scalars());
  const int threads = worthwhileThreads(problem_.threads(), nanosecondsPerNumber * scalars);
  return threads > 1 ? readyThreads(threads) : 1;
}

std::string Descent::describeBadEdge(const CostTotals& totals) const {
  const Edge& edge = problem_.batch(totals.badBatch).edge(totals.badEdge);
  std::string ids;
  for (const std::int64_t id : edge.vertexIds()) ids += fmt::format(" {}", id);
  const std::string name = problem_.edgeType(totals.badBatch).tag() + ids;
  if (edge.robustKernel() && std::isfinite(totals.chi2))
    return fmt::format("robust kernel {} makes the error of edge {} a cost that is not finite",
                       edge.robustKernel().name(), name);
  return fmt::format("the error of edge {} is not finite", name);
}

bool Descent::begin() {
  watch_ = Stopwatch();
  totals_.chi2 = totals_.cost = std::numeric_limits<double>::quiet_NaN();  // should linearising be stopped
  summary_.initialChi2 = summary_.initialCost = totals_.cost;
  totals_ = system_.linearize(problem_.state());
  summary_.initialChi2 = summary_.finalChi2 = totals_.chi2;
  summary_.initialCost = summary_.finalCost = totals_.cost;
  bestTotals_ = totals_;
  if (!totals_.finite()) {
    finish(Status::numericalFailure,
           describeBadEdge(totals_) + " at the start; check its measurement and the estimates of its vertices");
    return false;
  }
  if (totals_.cost < 0.0) {
    finish(Status::numericalFailure,
           ShortText("the cost at the start is {:.6g}: a robust kernel must not be negative; checkKernels tells which "
                     "one is",
                     totals_.cost));
    return false;
  }
  if (!measureGradient()) return false;
  if (gradient_ == 0.0) {
    finish(Status::converged,
           totals_.cost > 0.0
               ? ShortText("the gradient is zero at the start, at a cost of {:.6g}: an optimum, or where "
                           "errors or robust kernels have no slope",
                           totals_.cost)
               : ShortText("the cost is zero at the start"));
    return false;
  }
  if (costIsRounding()) {
    finish(Status::converged, "the cost at the start is what rounding makes of zero");
    return false;
  }
  return true;
}

bool Descent::measureGradient() {
  const auto gradient = system_.gradient();
  const auto diagonal = system_.diagonal();
  const auto part = [&](std::size_t begin, std::size_t end) {
    return sizeOf(gradient.subspan(begin, end - begin), diagonal.subspan(begin, end - begin));
  };
  const GradientSize size = overPieces(gradient.size(), vectorThreads(), part, joinSizes);
  gradient_ = size.largest;
  scaledGradient_ = std::sqrt(size.quotient);
  if (size.zero == 0.0) return true;  // the largest number does not tell
  finish(Status::numericalFailure, describeBadJacobian(problem_));
  return false;
}

bool Descent::exhausted() {
  if (ended_) return true;
  switch (stop_.reason()) {
    case StopCondition::Reason::interrupted:
      finish(Status::interrupted, interruptedReason);
      return true;
    case StopCondition::Reason::timeLimit:
      finish(Status::timeLimit,
             ShortText("the time limit of {:.3g} s is reached; the best estimate so far is kept", options_.timeLimit));
      return true;
    case StopCondition::Reason::none:
      break;
  }
  if (static_cast<int>(summary_.iterations.size()) >= options_.maxIterations) {
    finish(Status::iterationLimit, ShortText("{} trial steps are used up", options_.maxIterations));
    return true;
  }
  return false;
}

CostTotals Descent::tryStep() {
  Stopwatch watch;
  const Problem::StepLengths lengths = problem_.retract(memory_.delta);
  relativeStep_ = lengths.step / (lengths.state + 1e-10);
  report_.seconds.update += watch.lap();
  // After a rejected step the next one is likely to be rejected too: then the cost alone is computed.
  if (!rejected_) {
    if (const auto tried = system_.tryState(problem_.trial())) return *tried;
  }
  const CostTotals trial = problem_.evaluate(problem_.trial());
  report_.seconds.evaluate += watch.lap();
  return trial;
}

bool Descent::accept(const CostTotals& trial) {
  if (trial.cost > totals_.cost && totals_.cost <= bestTotals_.cost) {
    problem_.saveBest();
    bestSaved_ = true;
  }
  const double costBefore = totals_.cost;
  rejected_ = false;
  report_.gradient = gradient_;
  problem_.acceptTrial();
  totals_ = trial;
  unreported_ = true;
  system_.linearize(problem_.state());
  const bool finite = measureGradient();
  if (totals_.cost <= bestTotals_.cost) {
    bestTotals_ = totals_;
    bestSaved_ = false;
  }
  emitReport(true);
  return !finite || stopRuleMet(costBefore);
}

void Descent::reject() {
  rejected_ = true;
  system_.dropTrial();
  report_.gradient = gradient_;
  emitReport(false);
}

void Descent::emitReport(bool accepted) {
  report_.iteration = static_cast<int>(summary_.iterations.size());
  report_.accepted = accepted;
  unreported_ = false;
  report_.chi2 = totals_.chi2;
  report_.cost = totals_.cost;
  report_.relativeStep = relativeStep_;
  system_.addSeconds(report_.seconds);
  report_.seconds.total = watch_.lap();
  summary_.iterations.push_back(report_);
  if (options_.callback) callBack();
  report_ = {};
}

void Descent::callBack() {
  const GraphWatch watch(problem_.graph());
  options_.callback(report_);
  watch.require("callback");
}

bool Descent::stopRuleMet(double costBefore) {
  const double change = std::abs(costBefore - totals_.cost);
  if (totals_.cost == 0.0) {
    finish(Status::converged, "the cost is zero");
    return true;
  }
  const bool shortened = reach_ == StepReach::shortened || damping_ > detail::mostTellingDamping;
  const bool tells = reach_ != StepReach::held && !(shortened && isSteep());
  if (tells && change < options_.costTolerance * std::abs(totals_.cost) &&
      !(damping_ == 0.0 && goesToAndFro(costBefore))) {
    finish(Status::converged, ShortText("the cost changed by {:.2e} of itself, less than {:.0e} is asked",
                                        change / totals_.cost, options_.costTolerance));
    return true;
  }
  if (costIsRounding()) {
    finish(Status::converged, "the cost is what rounding makes of zero");
    return true;
  }
  if (totals_.cost >= costBefore && damping_ == 0.0 && atRest(true)) {
    finishAtRest();
    return true;
  }
  // Relative to the first gradient it would be met far from the optimum whenever one error was huge at the start.
  const double gradient = scaledGradient_ / std::sqrt(std::abs(totals_.cost));
  if (gradient < options_.gradientTolerance) {
    finish(Status::converged, ShortText("the gradient is {:.2e} of the residual, less than {:.0e} is asked", gradient,
                                        options_.gradientTolerance));
    return true;
  }
  if (tells && relativeStep_ < options_.stepTolerance && costRests(costBefore)) {
    finish(Status::converged, ShortText("the step is {:.2e} of the estimate, less than {:.0e} is asked", relativeStep_,
                                        options_.stepTolerance));
    return true;
  }
  return false;
}

/// Far from the origin, small parts of ‖x‖ are long steps, and damped ones may be short anywhere: after a short step
/// the cost must rest too, if it is asked. Where it still falls, however little, it does not: weights of robust kernels
/// settle slowly. Where it rises, by no more than rounding explains, only rounding moves it.
bool Descent::costRests(double costBefore) const {
  if (options_.costTolerance == 0.0) return true;
  if (damping_ > 0.0 || totals_.cost < costBefore) return false;
  return totals_.cost - costBefore <= 2.0 * std::sqrt(totals_.cost * roundings());
}

bool Descent::costIsRounding() const {
  return options_.costTolerance > 0.0 && totals_.cost >= 0.0 &&
         totals_.cost <= negligibleCost * static_cast<double>(problem_.edges()) && totals_.cost <= roundings();
}

double Descent::roundings() const {
  const auto diagonal = system_.diagonal();
  double sum = 0.0;  // Σ Hᵢᵢ x², x the number that moves or, on a manifold, the largest of the vertex
  for (int variable = 0; variable < problem_.variables(); ++variable) {
    const int slot = problem_.slotOfVariable(variable);
    const double* const values = problem_.state().record(slot);
    double largest = 0.0;
    for (int i = 0; i < problem_.layout().valueCount(slot); ++i) largest = std::max(largest, std::abs(values[i]));
    const auto offset = static_cast<std::size_t>(problem_.offset(variable));
    const bool plain = problem_.layout().valueCount(slot) == problem_.dimension(variable);
    for (int i = 0; i < problem_.dimension(variable); ++i) {
      const double x = plain ? values[i] : largest;
      sum += diagonal[offset + static_cast<std::size_t>(i)] * x * x;
    }
  }
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  constexpr double onTheWay = 10.0;  // roundings from an estimate to an error, about, squared
  return onTheWay * epsilon * epsilon * sum;
}

void Descent::finish(Status status, std::string_view reason) {
  summary_.status = status;
  summary_.reason = reason;
  ended_ = true;
}

void Descent::finishWithoutProspect(double predicted) {
  finish(Status::converged,
         ShortText("no step can lower the cost by more than {:.2e} of itself", predicted / totals_.cost));
}

bool Descent::atRest(bool fullStep) {
  constexpr double littleStep = 1e-7;
  constexpr double littleDamping = 1e-3;
  constexpr double fallen = 1e-16;
  if (!(options_.costTolerance > 0.0) || !(totals_.cost >= 0.0)) return false;
  if (totals_.cost > negligibleCost * static_cast<double>(problem_.edges())) return false;
  const bool still = totals_.cost <= fallen * summary_.initialCost ||
                     (fullStep && damping_ <= littleDamping && relativeStep_ <= littleStep);
  return still && !followsGradient();
}

bool Descent::followsGradient() {
  // H and D differ by at most the number of variables that an edge joins or so, so that the way is nearly straight.
  constexpr double share = 1.0 / 1024.0;
  const auto gradient = system_.gradient();
  const auto diagonal = system_.diagonal();
  std::vector<double> step(gradient.size(), 0.0);
  double promised = 0.0;
  for (std::size_t i = 0; i < step.size(); ++i) {
    if (!(diagonal[i] > 0.0)) continue;
    step[i] = -share * gradient[i] / diagonal[i];
    promised -= 2.0 * gradient[i] * step[i];
  }
  problem_.retract(step);
  const double kept = problem_.evaluate(problem_.trial()).cost;
  const double fallen = totals_.cost - kept;
  return fallen > 0.5 * promised && fallen < 1.5 * promised;
}

bool Descent::goesToAndFro(double costBefore) const {
  return std::abs(costBefore - totals_.cost) < options_.costTolerance * std::abs(totals_.cost) && isSteep();
}

bool Descent::isSteep() const {
  constexpr double steep = 1e4;
  constexpr double always = 0.01;
  const double tolerance = options_.costTolerance;
  const double share = std::max(tolerance, std::min(steep * tolerance, always));
  return scaledGradient_ * scaledGradient_ > share * std::abs(totals_.cost);
}

void Descent::finishAtRest() {
  finish(Status::converged, ShortText("no step lowers the cost, which is {:.2e} an edge",
                                      totals_.cost / static_cast<double>(problem_.edges())));
}

void Descent::fail(const LinearOutcome& outcome) {
  if (outcome.kind == LinearOutcome::Kind::interrupted) {
    stopMidway();
    return;
  }
  finish(Status::numericalFailure,
         diagnoseFailure(problem_, system_, outcome, summary_.plan.algorithm.ends_with("lm")));
}

void Descent::stopMidway() {
  if (unreported_) emitReport(true);
  if (!exhausted()) finish(Status::interrupted, interruptedReason);
}

void Descent::returnToBest() {
  if (!bestSaved_ || totals_.cost <= bestTotals_.cost) return;
  problem_.restoreBest();
  totals_ = bestTotals_;
  system_.linearize(problem_.state());
  bestSaved_ = false;
  (void)measureGradient();
}

void Descent::end() {
  system_.addSeconds(report_.seconds);
  if (bestSaved_ && totals_.cost > bestTotals_.cost) {
    const double settled = totals_.cost;
    bool above = summary_.status == Status::converged && settled > bestTotals_.cost * (1.0 + 1e-9) &&
                 relativeStep_ > options_.stepTolerance;
    try {
      above = above && !atRest(true);
    } catch (const WorkStopped&) {
      above = false;  // no time to ask
    }
    problem_.restoreBest();
    totals_ = bestTotals_;
    if (above) {
      finish(Status::stalled, "full steps settle at a cost above the lowest met, which is kept; try --algorithm lm");
    }
  }
  summary_.finalChi2 = totals_.chi2;
  summary_.finalCost = totals_.cost;
}

}  // namespace quiver
