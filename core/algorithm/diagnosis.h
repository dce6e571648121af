#pragma once

#include <string>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/core/problem/problem.h>

namespace quiver {

/// Why a linear system could not be solved, in words: the vertex, its type, the directions that nothing constrains in
/// the names of its tangent, the edges around it, and what to do, damping included unless steps were damped. `system`
/// holds the linearisation that failed.
std::string diagnoseFailure(const Problem& problem, LinearSystem& system, const LinearOutcome& outcome, bool damped);

/// Why the gradient is not finite though the cost is: the edge whose Jacobian is not.
std::string describeBadJacobian(const Problem& problem);

}  // namespace quiver
