#pragma once

#include <span>
#include <string_view>

namespace quiver::app {

/// What a solver name of g2o's command stands for here. An algorithm and a linear solver; the block sizes in a name
/// choose nothing, since every dimension is fast and elimination follows from the structure.
struct SolverName {
  std::string_view name;
  std::string_view algorithm;
  /// "cholmod" only where it is built in.
  std::string_view solver;
  /// The initial guess that belongs to the algorithm; empty if none does.
  std::string_view init = "";
  /// If not 0: only vertices of this dimension move.
  int onlyDimension = 0;
};

/// Every name that g2o registers, in its families: Eigen and CSparse (here "block", which takes their place), CHOLMOD,
/// dense, PCG, the linear start in the plane, and structure alone.
std::span<const SolverName> solverNames();

/// nullptr if it is no such name.
const SolverName* findSolverName(std::string_view name);

}  // namespace quiver::app
