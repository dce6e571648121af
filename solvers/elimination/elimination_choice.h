#pragma once

#include <string>
#include <vector>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/problem/problem.h>

namespace quiver {

/// Which variables are eliminated before the rest is solved for, and why.
struct EliminationChoice {
  /// By variable; no edge joins two of them.
  std::vector<char> eliminated;
  std::int64_t count = 0;
  /// Tags of their types, in the order of choice.
  std::vector<std::string> types;
  std::string reason;
};

/// Decides from structure and options alone.
///
/// Types are tried in ascending order of dimension, then in descending order of number. Of a type every vertex that no
/// edge joins to a vertex chosen before is taken, those of few neighbours first. Automatically, a type is taken only if
/// most of it can be, vertices with more neighbours than these have themselves stay behind (minimum degree would not
/// eliminate them first either), and the predicted multiplications must not exceed those of the whole system in its own
/// best order by a fifth. With EliminationPolicy::types the named types are taken whatever they cost. Throws GraphError
/// if a named type is unknown. O(edges · roles²), and an ordering of the whole system where the answer is not plain.
EliminationChoice chooseElimination(const Problem& problem, const Options& options);

}  // namespace quiver
