#include <quiver/core/algorithm/structure_key.h>

#include <bit>

namespace quiver {
namespace {

/// Two independent multiply-rotate hashes of a sequence of words.
class Hash {
 public:
  void add(std::uint64_t word) {
    first_ = std::rotl((first_ ^ word) * 0x9e3779b97f4a7c15ULL, 29);
    second_ = std::rotl(second_ ^ (word * 0xc2b2ae3d27d4eb4fULL), 31) * 0x165667b19e3779f9ULL + 1;
  }
  std::uint64_t first() const { return first_; }
  std::uint64_t second() const { return second_; }

 private:
  std::uint64_t first_ = 1;
  std::uint64_t second_ = 2;
};

}  // namespace

StructureKey::StructureKey(const Graph& graph, const Options& options, int threads)
    : graph_(&graph),
      stamp_(graph.stamp()),
      vertices_(graph.vertexCount()),
      edges_(graph.edgeCount()),
      threads_(threads),
      level_(options.level),
      gauge_(options.gauge),
      solver_(options.linearSolver),
      algorithm_(options.algorithm),
      free_(options.free),
      elimination_(options.elimination),
      eliminatedTypes_(options.eliminatedTypes),
      memoryLimit_(options.memoryLimit) {
  Hash hash;
  graph.forEachVertex([&](const Vertex& vertex) {
    hash.add(vertex.fixedDirections());
    hash.add(static_cast<std::uint64_t>(vertex.hasEstimate()));
  });
  graph.forEachEdge([&](const Edge& edge) { hash.add(static_cast<std::uint64_t>(edge.level())); });
  hash_[0] = hash.first();
  hash_[1] = hash.second();
}

}  // namespace quiver
