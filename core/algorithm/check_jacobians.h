#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver {

/// One entry of an edge's Jacobian, as the type computes it and as differences of its error say.
struct JacobianEntry {
  std::vector<std::int64_t> vertices;
  int role = 0;
  int row = 0;
  int column = 0;
  /// Name of the tangent's direction.
  std::string direction;
  double computed = 0.0;
  double expected = 0.0;
  /// |computed − expected| less what rounding and bending explain, relative to the largest entry of its row in the
  /// block, or to 1e-9 of the block's largest if that is more; infinite if one of them is not finite.
  double deviation = 0.0;
};

/// What was found for one edge type.
struct JacobianComparison {
  std::string tag;
  EdgeForm form;
  std::int64_t edges = 0;
  /// Columns that were left out since the error jumps within every step, as an angle does at ±π. If all were, the worst
  /// deviation is infinite.
  std::int64_t jumps = 0;
  JacobianEntry worst;
};

struct JacobianReport {
  /// In the order of the tags.
  std::vector<JacobianComparison> types;

  double worstDeviation() const;
  /// One line a type: its form, the edges compared, the worst entry.
  std::string describe() const;
};

struct JacobianCheckOptions {
  /// Edges of each type that are compared, spread evenly; 0 means all.
  std::int64_t edgesPerType = 1000;
  /// First step of the differences in every direction of the tangent, times the cube root of the largest number of the
  /// estimate if that is more than 1; shorter ones follow where the error is not smooth within it.
  double step = 1e-5;
};

/// Compares the Jacobians of a graph's edges, at its estimates, with central differences (extrapolated from two steps)
/// of the error along `VertexType::retract`. Correct Jacobians deviate by about 1e-9. Information and robust kernels do
/// not matter, fixed vertices are compared too. Throws GraphError if a vertex has no estimate. O(edges), on a copy of
/// the graph.
JacobianReport checkJacobians(const Graph& graph, const JacobianCheckOptions& options = {});

}  // namespace quiver
