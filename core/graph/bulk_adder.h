#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver::detail {

/// How many elements of each type a part of a graph has, by the type's index in the registry.
struct ElementCounts {
  ElementCounts() = default;
  explicit ElementCounts(const Registry& registry)
      : vertices(registry.vertexTypes().size(), 0), edges(registry.edgeTypes().size(), 0) {}

  std::vector<std::int64_t> vertices;
  std::vector<std::int64_t> edges;
};

/// Adds vertices and edges in parts, which several threads may fill at once. How many elements each part has is known
/// before: memory comes in one piece, and a type's elements lie in the order of the parts and, within a part, in the
/// order in which they are added, whichever thread comes first.
///
///     name every vertex, part by part;  open();  for each part, on any thread: begin(), addVertex(), addEdge();
///     finish()
///
/// Meanwhile the graph must not be changed otherwise, except that between open() and the first begin() vertices and
/// parameters may be added. If anything throws, the graph is good for nothing but to be destroyed, after this object.
class BulkAdder {
 public:
  BulkAdder(Graph& graph, std::vector<ElementCounts> parts);
  ~BulkAdder();
  BulkAdder(const BulkAdder&) = delete;
  BulkAdder& operator=(const BulkAdder&) = delete;

  /// The id ≥ 0 of the next vertex of a type. Returns false if it is taken.
  bool nameVertex(int type, std::int64_t id);
  void open();

  /// Makes the elements of a part, blank. Like the next two, thread safe for parts that differ.
  void begin(std::size_t part) noexcept;
  /// Vertices come in the order in which they were named.
  Vertex& addVertex(std::size_t part, int type, std::int64_t id);
  /// Throws GraphError as Graph::addEdge() does.
  Edge& addEdge(std::size_t part, int type, std::span<const std::int64_t> vertices,
                std::span<const std::int64_t> parameters);

  /// Every part has all its elements.
  void finish();

 private:
  struct Part {
    ElementCounts counts;
    /// Where the next element of each type goes.
    ElementCounts slots;
    bool begun = false;
  };

  Graph& graph_;
  std::vector<Part> parts_;
  ElementCounts totals_;
  /// By type; nullptr before open() and where a type has no element.
  std::vector<ElementPool<Vertex>*> vertexPools_;
  std::vector<ElementPool<Edge>*> edgePools_;
  /// Slots of the vertices to be named next, by type.
  std::vector<std::int64_t> named_;
};

}  // namespace quiver::detail
