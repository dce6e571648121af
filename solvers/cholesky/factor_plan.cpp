#include <quiver/solvers/cholesky/factor_plan.h>

#include <quiver/solvers/cholesky/factor_plan_builder.h>

namespace quiver::detail {
namespace {

template <typename T>
std::int64_t bytesOf(const std::vector<T>& list) {
  return static_cast<std::int64_t>(list.capacity() * sizeof(T));
}

}  // namespace

FactorPlan::FactorPlan(const BlockPattern& pattern, int threads) { FactorPlanBuilder(*this, pattern, threads); }

std::int64_t FactorPlan::bytes() const {
  return bytesOf(nodes) + bytesOf(storage) + bytesOf(blocks) + bytesOf(blockScalar) + bytesOf(patternScalar) +
         bytesOf(loadBegin) + bytesOf(loads) + bytesOf(children) + bytesOf(runs) + bytesOf(spans) +
         bytesOf(leafColumns) + bytesOf(leafRows) + bytesOf(leafPositions) + bytesOf(panels) + bytesOf(panelRuns) +
         leafDestinationCount * 4;
}

}  // namespace quiver::detail
