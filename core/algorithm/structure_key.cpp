#include <quiver/core/algorithm/structure_key.h>

#include <algorithm>
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

StructureKey::StructureKey(const Graph& graph, const Options& options, int threads, const StructureKey* before)
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
  if (before != nullptr) {
    std::copy_n(before->hash_, 2, hash_);
    return;
  }
  Hash hash;
  graph.forEachVertex([&](const Vertex& vertex) {
    hash.add(vertex.fixedDirections());
    hash.add(static_cast<std::uint64_t>(vertex.hasEstimate()));
    const VertexType& type = graph.typeOf(vertex);
    if (type.dimension() == Dynamic) hash.add(static_cast<std::uint64_t>(type.dimension(vertex)));
  });
  bool robust = false;  // what the algorithm and with it the gauge are chosen by
  graph.forEachEdge([&](const Edge& edge) {
    robust = robust || edge.robustKernel();
    hash.add(static_cast<std::uint64_t>(edge.level()));
    const EdgeType& type = graph.typeOf(edge);
    if (type.errorDimension() == Dynamic) hash.add(static_cast<std::uint64_t>(type.errorDimension(edge)));
  });
  hash.add(static_cast<std::uint64_t>(robust));
  hash_[0] = hash.first();
  hash_[1] = hash.second();
}

}  // namespace quiver
