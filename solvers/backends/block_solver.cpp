#include <quiver/solvers/backends/block_solver.h>

#include <quiver/solvers/cholesky/block_cholesky.h>

namespace quiver {

std::unique_ptr<LinearSolver> makeBlockSolver() { return std::make_unique<detail::BlockCholesky>(); }

std::int64_t predictBlockSolverBytes(const BlockPattern& pattern, int threads) {
  return detail::BlockCholesky::predictBytes(pattern, threads);
}

}  // namespace quiver
