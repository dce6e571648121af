#include <quiver/core/algorithm/structure_key.h>

#include <algorithm>
#include <bit>
#include <span>

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

/// A bit for each diagonal entry of an upper triangle, row by row, that is zero.
std::uint64_t weightless(std::span<const double> triangle, int rows) {
  std::uint64_t bits = 0;
  std::size_t at = 0;
  for (int row = 0; row < rows && at < triangle.size(); at += static_cast<std::size_t>(rows - row), ++row) {
    if (triangle[at] == 0.0) bits ^= std::uint64_t{1} << row % 64;
  }
  return bits;
}

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
      memoryLimit_(options.memoryLimit),
      linearTolerance_(options.linearTolerance),
      maxLinearIterations_(options.maxLinearIterations) {
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
  std::vector<std::int64_t> free = options.free;
  std::sort(free.begin(), free.end());
  const auto takesPart = [&](const Edge& edge) {
    if (options.level >= 0 && edge.level() != options.level) return false;
    return free.empty() || std::ranges::any_of(edge.vertexIds(), [&](std::int64_t id) {
             return std::binary_search(free.begin(), free.end(), id);
           });
  };
  bool robust = false;  // what the algorithm and with it the gauge are chosen by
  graph.forEachEdge([&](const Edge& edge) {
    robust = robust || (edge.robustKernel() && takesPart(edge));
    hash.add(static_cast<std::uint64_t>(edge.level()));
    const EdgeType& type = graph.typeOf(edge);
    const int rows = type.errorDimension(edge);
    if (type.errorDimension() == Dynamic) hash.add(static_cast<std::uint64_t>(rows));
    hash.add(weightless(type.information(edge), rows));
  });
  hash.add(static_cast<std::uint64_t>(robust));
  hash_[0] = hash.first();
  hash_[1] = hash.second();
}

}  // namespace quiver
