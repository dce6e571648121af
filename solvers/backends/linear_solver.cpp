#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

BlockOrdering LinearSolver::order(const BlockPattern& pattern) const { return naturalOrdering(pattern.blocks()); }

}  // namespace quiver
