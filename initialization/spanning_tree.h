#pragma once

#include <string>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// Estimates by dead reckoning along the paths that accumulate the least variance.
///
/// A tree of shortest paths (Dijkstra) grows from the roots; an edge is as long as the trace of its covariance Ω⁻¹, or
/// very long where Ω is singular. Paths of equal length are told apart by their number of edges, then by the vertex's
/// id, then by the edge's place in canonical order, so the order in which the graph was built does not matter. Each
/// vertex reached gets the estimate that the last edge of its path tells (the edge type's `initialEstimate`); an edge
/// of more than two vertices tells one when all its others are known, and a unary edge (a prior) tells its own.
///
/// Roots are, per connected component: the vertices that are held, if they have an estimate, and those that a prior of
/// full rank tells; else one of those that have an estimate, which it keeps, or of all if none has, and that one is put
/// at the origin if that can be written and read back. Of several it is a pose if there is one, of the largest
/// dimension, of the lowest id. Where estimated landmarks cannot tell poses that have no estimate, a pose at the origin
/// tells the landmarks instead. Where edges cannot carry on from a root (a landmark does not tell a pose), the next
/// such vertex that has an estimate keeps it and becomes a root too. Held vertices, partly held ones included, keep
/// their estimates.
///
/// Edges of `options.level` take part, and where `options.free` names vertices, only those move. Returns a sentence for
/// the summary. Throws GraphError naming the first vertex that ends without an estimate. O(E log E) for E edges.
std::string spanningTreeEstimate(Graph& graph, const Options& options = {});

/// Estimates along the odometry: edges between vertices of consecutive ids come first, and where they end, the fewest
/// other edges lead on. Roots, ties, held vertices and errors are as for spanningTreeEstimate().
std::string odometryEstimate(Graph& graph, const Options& options = {});

}  // namespace quiver
