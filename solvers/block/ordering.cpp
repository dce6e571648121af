#include <quiver/solvers/block/ordering.h>

#include <numeric>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#ifdef QUIVER_METIS
#  include <metis.h>
#endif

#include <quiver/core/util/error.h>
#include <quiver/core/util/one_at_a_time.h>
#include <quiver/core/util/signals_blocked.h>
#include <quiver/solvers/block/factor_pattern.h>

namespace quiver {
namespace {

/// An order composed with a postorder of its elimination tree: the same factor, subtrees contiguous.
std::vector<int> postordered(const BlockGraph& graph, const std::vector<int>& order) {
  const EliminationTree tree(graph, order);
  std::vector<int> result;
  result.reserve(order.size());
  for (const int k : postorder(tree.parent)) result.push_back(order[static_cast<std::size_t>(k)]);
  return result;
}

std::vector<int> minimumDegree(const BlockGraph& graph) {
  const int count = graph.blocks();
  using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  Sparse matrix(count, count);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(graph.neighbours.size()) + count);
  int* outer = matrix.outerIndexPtr();
  int* inner = matrix.innerIndexPtr();
  int k = 0;
  for (int i = 0; i < count; ++i) {
    outer[i] = k;
    bool placed = false;
    for (const int neighbour : graph.of(i)) {
      if (!placed && neighbour > i) {
        inner[k++] = i;
        placed = true;
      }
      inner[k++] = neighbour;
    }
    if (!placed) inner[k++] = i;
  }
  outer[count] = k;
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::internal::minimum_degree_ordering(matrix, permutation);
  return {permutation.indices().data(), permutation.indices().data() + count};
}

#ifdef QUIVER_METIS
constexpr double minimumDissectionFlops = 1e8;
constexpr double minimumDissectionIntensity = 150.0;
constexpr int dissectionSeed = 2;
/// Thousandths by which the larger half may exceed its share. Pose graphs have narrow places off the middle: twice
/// METIS's default saves up to a tenth of the multiplications.
constexpr int dissectionImbalance = 400;

/// Empty if METIS fails.
std::vector<int> dissection(const BlockGraph& graph, const BlockLayout& layout) {
  auto count = static_cast<idx_t>(graph.blocks());
  std::vector<idx_t> starts(graph.starts.begin(), graph.starts.end());
  std::vector<idx_t> neighbours(graph.neighbours.begin(), graph.neighbours.end());
  std::vector<idx_t> weights(layout.dimensions().begin(), layout.dimensions().end());
  std::vector<idx_t> order(static_cast<std::size_t>(count));
  std::vector<idx_t> position(static_cast<std::size_t>(count));
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = dissectionSeed;
  options[METIS_OPTION_UFACTOR] = dissectionImbalance;
  int result = METIS_ERROR;
  // METIS draws from the C library's one sequence of random numbers: two searches at a time would disturb each other.
  oneAtATime([&] {
    // METIS catches SIGTERM for its own purposes while it runs, and would end with an error. Now it comes afterwards.
    const SignalsBlocked blocked;
    result =
        METIS_NodeND(&count, starts.data(), neighbours.data(),
                     layout.uniformDimension() != 0 ? nullptr : weights.data(), options, order.data(), position.data());
  });
  if (result != METIS_OK) return {};
  return {order.begin(), order.end()};
}
#endif

}  // namespace

BlockOrdering naturalOrdering(int blocks) {
  BlockOrdering ordering{std::vector<int>(static_cast<std::size_t>(blocks)), "natural"};
  std::iota(ordering.order.begin(), ordering.order.end(), 0);
  return ordering;
}

BlockOrdering amdOrdering(const BlockPattern& pattern) {
  if (pattern.blocks() < 3) return naturalOrdering(pattern.blocks());
  const BlockGraph graph(pattern);
  return {postordered(graph, minimumDegree(graph)), "amd"};
}

#ifdef QUIVER_METIS
bool hasMetis() { return true; }

BlockOrdering metisOrdering(const BlockPattern& pattern) {
  const BlockGraph graph(pattern);
  if (graph.neighbours.empty()) return naturalOrdering(pattern.blocks());
  const std::vector<int> order = dissection(graph, pattern.layout());
  if (order.empty()) throw LogicError("METIS found no order");
  return {postordered(graph, order), "metis"};
}
#else
bool hasMetis() { return false; }

BlockOrdering metisOrdering(const BlockPattern&) { throw LogicError("nested dissection needs a build with METIS"); }
#endif

BlockOrdering chooseOrdering(const BlockPattern& pattern) {
  if (pattern.blocks() < 3) return naturalOrdering(pattern.blocks());
  const BlockGraph graph(pattern);
  BlockOrdering best{postordered(graph, minimumDegree(graph)), "amd"};
#ifdef QUIVER_METIS
  const FactorSize amd = predictFactor(graph, pattern.layout(), best.order);
  const bool worthTrying =
      amd.flops > minimumDissectionFlops && amd.flops > minimumDissectionIntensity * static_cast<double>(amd.nonzeros);
  if (worthTrying) {
    std::vector<int> order = dissection(graph, pattern.layout());
    if (!order.empty()) order = postordered(graph, order);
    if (!order.empty() && predictFactor(graph, pattern.layout(), order).flops < amd.flops)
      best = {std::move(order), "metis"};
  }
#endif
  return best;
}

}  // namespace quiver
