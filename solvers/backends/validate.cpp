#include <quiver/solvers/backends/validate.h>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver::detail {

void validateFactorize(const std::string& solver, const BlockPattern* pattern, const BlockMatrix& matrix,
                       std::span<const double> damping) {
  if (pattern == nullptr) throw LogicError(fmt::format("{}: factorize before analyze", solver));
  const BlockPattern& other = matrix.pattern();
  if (&other != pattern && !(other == *pattern)) {
    throw LogicError(
        fmt::format("{}: factorize with a pattern of {} blocks and {} entries after analyze with {} and {}", solver,
                    other.blocks(), other.entries(), pattern->blocks(), pattern->entries()));
  }
  if (!damping.empty() && static_cast<std::int64_t>(damping.size()) != pattern->layout().scalars()) {
    throw LogicError(
        fmt::format("{}: damping of {} for {} scalars", solver, damping.size(), pattern->layout().scalars()));
  }
}

void validateSolve(const std::string& solver, bool factored, const BlockPattern* pattern,
                   std::span<const double> rightHandSides, int count) {
  if (!factored) throw LogicError(fmt::format("{}: solve without a factor", solver));
  if (count < 0 || static_cast<std::int64_t>(rightHandSides.size()) != count * pattern->layout().scalars()) {
    throw LogicError(fmt::format("{}: {} right-hand sides in {} scalars of a system of {}", solver, count,
                                 rightHandSides.size(), pattern->layout().scalars()));
  }
}

}  // namespace quiver::detail
