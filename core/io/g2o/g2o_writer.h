#pragma once

#include <optional>
#include <string>

#include <quiver/core/graph/graph.h>
#include <quiver/core/io/files/graph_format.h>

namespace quiver {

struct WriteOptions {
  /// Writes lines beginning with "#quiver " for what the format cannot hold: robust kernels, levels, partly fixed
  /// vertices, vertices without an estimate. g2o takes them for comments. Without them all that is lost.
  bool annotations = true;
  /// At most so many threads; 0: as many as the machine offers. The bytes are the same for any number.
  int threads = 0;
  /// As the name of the file asks for if there is none (see formatOfPath).
  std::optional<GraphFormat> format = {};
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
/// A name that ends in .graph or .toro, compressed or not, asks for TORO's format: VERTEX2, EDGE2, BR, VERTEX3 and
/// EDGE3; graphs with other types are refused. One that ends in .csv asks for a table: the lines of .g2o with commas,
/// and before the first of each type a row with the names of its fields.
///
/// Throws FileError if the file cannot be written, GraphError if a number is not finite or the format cannot hold the
/// graph. O(size).
void writeGraph(const std::string& path, const Graph& graph, const WriteOptions& options = {});

/// Throws GraphError if the format cannot hold the graph: to be asked before long work. O(size).
void checkFormat(GraphFormat format, const Graph& graph);
void checkFormat(const std::string& path, const Graph& graph);

/// What writeGraph() writes; .g2o where options.format is empty.
std::string graphText(const Graph& graph, const WriteOptions& options = {});

}  // namespace quiver
