#pragma once

#include <string>

#include <quiver/core/graph/graph.h>

namespace quiver {

struct WriteOptions {
  /// Writes lines beginning with "#quiver " for what the format cannot hold: robust kernels, levels, partly fixed
  /// vertices, vertices without an estimate. g2o takes them for comments. Without them all that is lost.
  bool annotations = true;
  /// At most so many threads; 0: as many as the machine offers. The bytes are the same for any number.
  int threads = 0;
};

/// Writes a graph as a .g2o file: parameters and vertices by id, each vertex followed by its data lines and FIX, then
/// edges, type by type.
///
/// Numbers have the shortest digits that read back to the same bits, so reading and writing again gives the same bytes.
/// The file is compressed if its name ends in .gz or .bz2, "-" is standard output, and it replaces an older one only
/// when it is complete. If no vertex has an estimate and edges name them all, vertices are left out: readGraph makes
/// them anew.
///
///     #quiver kernel NAME WIDTH [SHAPE]     the edge before
///     #quiver level N                       the edge before
///     #quiver fixed DIRECTION…              the vertex before; directions of the tangent, counted from 0
///     #quiver vertex TAG ID                 a vertex without an estimate
///
/// A name that ends in .bal, .bal.gz or .bal.bz2 asks for the format of "bundle adjustment in the large" instead, which
/// holds cameras, points and pixels alone: ids become 0, 1, …, comments and data lines are left out, and kernels,
/// levels or fixed vertices are refused.
///
/// Throws FileError if the file cannot be written, GraphError if a number is not finite or the format cannot hold the
/// graph. O(size).
void writeGraph(const std::string& path, const Graph& graph, const WriteOptions& options = {});

/// Throws GraphError if the format that the name asks for cannot hold the graph: to be asked before long work. O(size).
void checkFormat(const std::string& path, const Graph& graph);

/// What writeGraph() writes as .g2o.
std::string graphText(const Graph& graph, const WriteOptions& options = {});

}  // namespace quiver
