#pragma once

#include <span>
#include <string>

#include <quiver/solvers/block/block_matrix.h>

namespace quiver::detail {

/// Throws LogicError, naming the solver, unless `analyze` was called with a pattern equal to the matrix's and damping
/// has the right size.
void validateFactorize(const std::string& solver, const BlockPattern* pattern, const BlockMatrix& matrix,
                       std::span<const double> damping);

/// Throws LogicError, naming the solver, unless there is a factor and the right-hand sides have the right size.
void validateSolve(const std::string& solver, bool factored, const BlockPattern* pattern,
                   std::span<const double> rightHandSides, int count);

}  // namespace quiver::detail
