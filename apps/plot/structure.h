#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// Where a symmetric block matrix has entries, as a picture of at most `mostCells` cells a side.
struct MatrixPicture {
  static constexpr int mostCells = 256;

  std::string title;
  /// Blocks and scalars a side.
  std::int64_t blocks = 0;
  std::int64_t scalars = 0;
  /// Blocks and scalars that are stored, in both triangles; of a factor, in its lower one, with the lower triangles of
  /// its diagonal blocks.
  std::int64_t storedBlocks = 0;
  std::int64_t storedScalars = 0;
  /// Share of the matrix (of a factor: of its triangle) that is stored, from 0 to 1.
  double fill = 0.0;
  /// Cells a side, and row by row the share of each cell that is stored.
  int cells = 0;
  std::vector<float> shares;
};

/// H with the vertices that would be eliminated last, an arrow where there are any; the reduced matrix of those that
/// remain (for cameras: who sees what together), if any are eliminated; what is factorised once more in the order that
/// would be chosen; and its factor.
struct StructurePictures {
  std::vector<MatrixPicture> matrices;
  /// What is eliminated and why.
  std::string elimination;
};

/// No number of the graph matters; vertices without an estimate are put at the origin. Throws GraphError if nothing is
/// to be optimised.
StructurePictures pictureStructure(Graph& graph, const Options& options);

/// A self-contained SVG document: the matrices side by side with their figures.
std::string drawStructure(const StructurePictures& pictures);

}  // namespace quiver::app
