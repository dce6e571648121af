#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace quiver {

/// How an optimisation ended.
enum class Status {
  converged,
  iterationLimit,
  timeLimit,
  interrupted,
  stalled,
  numericalFailure,
  nothingToOptimise,
  memoryLimit
};

/// "converged", "iteration_limit", …: the words of the command and its JSON.
std::string_view toString(Status status);

/// Wall-clock seconds by phase.
struct PhaseSeconds {
  double linearize = 0.0;
  double assemble = 0.0;
  double eliminate = 0.0;
  double factorize = 0.0;
  double solve = 0.0;
  double update = 0.0;
  double evaluate = 0.0;
  double total = 0.0;
};

/// One trial step. chi2 and cost are those of the estimate kept after it.
struct IterationReport {
  int iteration = 0;
  double chi2 = 0.0;
  double cost = 0.0;
  bool accepted = false;
  double damping = 0.0;
  /// ‖Δ‖ / (‖x‖ + 1e-10)
  double relativeStep = 0.0;
  /// ‖g‖∞ where the step began.
  double gradient = 0.0;
  int linearIterations = 0;
  PhaseSeconds seconds;
};

/// What was decided before the first iteration, each with its reason.
struct SolvePlan {
  std::string algorithm;
  std::string algorithmReason;
  std::string linearSolver;
  std::string linearSolverReason;
  std::string ordering;
  std::string orderingReason;
  std::int64_t eliminated = 0;
  std::vector<std::string> eliminatedTypes;
  std::string eliminationReason;
  /// Unknown scalars, scalars of the factor, its multiplications and additions, bytes the solver holds.
  std::int64_t scalars = 0;
  std::int64_t factorNonzeros = 0;
  double factorFlops = 0.0;
  std::int64_t bytes = 0;
  /// The solver would have held more than Options::memoryLimit leaves: nothing was allocated.
  bool exceedsMemory = false;
  /// Ids of eliminated vertices that their edges leave undetermined: damped in those directions, if in part, or left as
  /// they are. Of the last linear system solved.
  std::vector<std::int64_t> singular;
};

/// What the world's freedom to move unnoticed was found to be.
struct GaugeReport {
  /// Ids of vertices that were held to remove it.
  std::vector<std::int64_t> fixed;
  /// Directions left free.
  int free = 0;
  /// Connected components of unknown vertices.
  int components = 0;
  std::string reason;
};

/// The outcome of `optimize`: status, reason, table; never an unexplained number.
struct Summary {
  Status status = Status::nothingToOptimise;
  /// A sentence: which test was met, or what went wrong where and what to do about it.
  std::string reason;
  double initialChi2 = 0.0;
  double finalChi2 = 0.0;
  double initialCost = 0.0;
  double finalCost = 0.0;
  std::vector<IterationReport> iterations;
  SolvePlan plan;
  GaugeReport gauge;
  int threads = 1;
  /// Unknown vertices and active edges.
  std::int64_t variables = 0;
  std::int64_t edges = 0;
  /// Ids of vertices left out because no edge touches them.
  std::vector<std::int64_t> isolated;
  struct Seconds {
    double compile = 0.0;
    double analyze = 0.0;
    double optimize = 0.0;
    double total = 0.0;
  } seconds;

  bool converged() const { return status == Status::converged; }
  /// As new; keeps the memory of its parts.
  void clear();
};

/// The table of iterations and the sentences around it.
std::ostream& operator<<(std::ostream& out, const Summary& summary);
/// One line of that table and its heading.
std::string iterationHeading();
std::string iterationLine(const IterationReport& report);

}  // namespace quiver
