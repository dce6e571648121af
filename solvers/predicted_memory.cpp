#include <quiver/solvers/predicted_memory.h>

#include <numeric>
#include <vector>

#include <quiver/solvers/backends/block_solver.h>
#include <quiver/solvers/block/factor_pattern.h>

namespace quiver {
namespace {

/// Memory of a peer's sparse factorisation, its lists and its copies of the matrix included, by that of its factor.
constexpr double factorExcess = 2.4;

}  // namespace

std::int64_t matrixNumbers(const BlockPattern& pattern) {
  const BlockLayout& layout = pattern.layout();
  std::int64_t numbers = 0;
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k)
      numbers += std::int64_t{layout.dimension(column)} * layout.dimension(pattern.row(k));
  }
  return numbers;
}

std::int64_t predictSolverBytes(const LinearSolver& solver, const BlockPattern& pattern, int threads) {
  const std::int64_t scalars = pattern.layout().scalars();
  const std::string name = solver.name();
  if (name == "dense") return scalars * (scalars + 16) * 8;
  if (name == "pcg" || name == "power") return (scalars * 6 + std::int64_t{pattern.blocks()} * 100) * 8;
  if (name == "block") return predictBlockSolverBytes(pattern, threads);
  std::vector<int> order(static_cast<std::size_t>(pattern.blocks()));
  std::iota(order.begin(), order.end(), 0);
  return static_cast<std::int64_t>(factorExcess * 8.0 * static_cast<double>(predictFactor(pattern, order).nonzeros));
}

}  // namespace quiver
