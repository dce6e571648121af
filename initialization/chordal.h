#pragma once

#include <string>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// Estimates by chordal relaxation: rotations as free matrices that minimise Σ κ ‖R_j − R_i R_ij‖², a linear problem,
/// each then moved to the nearest rotation; then translations that minimise Σ τ ‖t_j − t_i − R_i t_ij‖², linear again.
/// (Martinec and Pajdla 2007; Carlone et al. 2015.) Weights are isotropic, from the information matrices. It does not
/// depend on the estimates the graph has, but for those of fixed vertices and, in each component without any, of the
/// first pose that has one.
///
/// Vertices that are no poses (landmarks) are then told by edges from the poses. Returns a sentence for the summary.
/// Throws GraphError if there are no poses, if poses do not hang together by relative-pose edges, or if a vertex ends
/// without an estimate, and WorkStopped once `options` ask to stop; estimates are then as they were. The cost is two
/// sparse factorisations of a third and a sixth of the pose problem's size.
std::string chordalEstimate(Graph& graph, const Options& options = {});

}  // namespace quiver
