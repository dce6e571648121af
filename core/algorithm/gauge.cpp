#include <quiver/core/algorithm/gauge.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include <quiver/core/algorithm/gauge_holds.h>
#include <quiver/core/problem/lane_records.h>
#include <quiver/core/util/parallel.h>
#include <quiver/geometry/scalar/isa.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace quiver {
namespace {

class DisjointSets {
 public:
  explicit DisjointSets(int count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int i) {
    while (at(i) != i) {
      at(i) = at(at(i));
      i = at(i);
    }
    return i;
  }
  void unite(int a, int b) {
    a = find(a);
    b = find(b);
    if (a != b) at(std::max(a, b)) = std::min(a, b);
  }

 private:
  int& at(int i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<int> parent_;
};

using Generators = detail::GaugeProducts;
using Combinations = detail::GaugeCombinations;

constexpr int padded = detail::gaugeRow;
/// Edges a piece, at least; pieces at most.
constexpr std::int64_t pieceEdges = 4096;
constexpr std::int64_t mostPieces = 16;
/// (J G)ᵀ(J G) cancels to ε²; genuine priors of weight 1e-14 of the sum are priors no more.
constexpr double unnoticed = 1e-14;
/// What some edges notice so clearly the others cannot hide.
constexpr double clearlyNoticed = 1e-4;

/// Σ (J G)ᵀ(J G) over the edges of a component, and Σ over edges and roles of ‖J_role G‖² per generator, the scale of
/// the sum; and GᵀG.
struct Products {
  std::array<double, gaugeDirections * padded> square{};
  std::array<double, padded> scale{};
  Generators gram = Generators::Zero();

  void add(const Products& other) {
    for (std::size_t i = 0; i < square.size(); ++i) square[i] += other.square[i];
    for (std::size_t i = 0; i < scale.size(); ++i) scale[i] += other.scale[i];
  }
};

std::vector<ComponentGauge> components(const Problem& problem, std::vector<int>& componentOf) {
  DisjointSets sets(problem.variables());
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    for (int i = 0; i < batch.size(); ++i) {
      int first = -1;
      for (const std::int32_t slot : batch.slots(i)) {
        const int variable = problem.variableOfSlot(slot);
        if (variable < 0) continue;
        if (first < 0) {
          first = variable;
        } else {
          sets.unite(first, variable);
        }
      }
    }
  }
  std::vector<ComponentGauge> result;
  componentOf.assign(static_cast<std::size_t>(problem.variables()), -1);
  for (int v = 0; v < problem.variables(); ++v) {
    const int root = sets.find(v);  // the smallest variable of its component, so it is numbered first
    if (root == v) {
      componentOf[static_cast<std::size_t>(v)] = static_cast<int>(result.size());
      result.emplace_back();
    }
    componentOf[static_cast<std::size_t>(v)] = componentOf[static_cast<std::size_t>(root)];
    result[static_cast<std::size_t>(componentOf[static_cast<std::size_t>(v)])].variables.push_back(v);
  }
  return result;
}

int findAnchor(const Problem& problem, const std::vector<int>& variables) {
  int anchor = -1;
  for (const int v : variables) {
    if (anchor >= 0) {
      if (problem.dimension(v) < problem.dimension(anchor)) continue;
      const bool lower =
          problem.vertex(problem.slotOfVariable(v)).id() < problem.vertex(problem.slotOfVariable(anchor)).id();
      if (problem.dimension(v) == problem.dimension(anchor) && !lower) continue;
    }
    anchor = v;
  }
  return anchor;
}

/// Generators of every slot, dimension rows of eight; none for fixed slots and for types that supply none.
std::vector<double> slotGenerators(const Problem& problem, std::vector<std::int64_t>& begin,
                                   const std::vector<int>& componentOf, std::vector<ComponentGauge>& gauges) {
  std::vector<double> all;
  std::vector<double> own;
  begin.assign(static_cast<std::size_t>(problem.slots()), -1);
  for (int slot = 0; slot < problem.slots(); ++slot) {
    const int variable = problem.variableOfSlot(slot);
    if (variable < 0) continue;
    const int dimension = problem.dimension(variable);
    const auto at = static_cast<std::int64_t>(all.size());
    own.assign(static_cast<std::size_t>(dimension * gaugeDirections), 0.0);
    if (!problem.vertexType(slot).gaugeGenerators(problem.state().record(slot), own.data())) {
      gauges[static_cast<std::size_t>(componentOf[static_cast<std::size_t>(variable)])].tested = false;
      continue;
    }
    all.resize(all.size() + static_cast<std::size_t>(dimension * padded), 0.0);
    const std::uint64_t held = problem.heldDirections(variable);
    for (int r = 0; r < dimension; ++r) {
      if (r < 64 && (held >> r & 1) != 0) continue;
      std::copy_n(own.data() + r * gaugeDirections, static_cast<int>(gaugeDirections), all.data() + at + r * padded);
    }
    begin[static_cast<std::size_t>(slot)] = at;
  }
  return all;
}

/// Combinations of generators, a column each: eigenvectors with eigenvalues below `zero` of the rows and columns `live`
/// of a matrix that is scaled by the roots of `scale`.
Combinations nullSpace(const Generators& matrix, std::span<const double> scale, const std::vector<int>& live,
                       double zero) {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, gaugeDirections, gaugeDirections> scaled(live.size(),
                                                                                                    live.size());
  for (std::size_t a = 0; a < live.size(); ++a) {
    for (std::size_t b = 0; b < live.size(); ++b) {
      const double product = scale[static_cast<std::size_t>(live[a])] * scale[static_cast<std::size_t>(live[b])];
      scaled(static_cast<int>(a), static_cast<int>(b)) = matrix(live[a], live[b]) / std::sqrt(product);
    }
  }
  const Eigen::SelfAdjointEigenSolver<decltype(scaled)> eigen(scaled);
  const auto count = (eigen.eigenvalues().array() < zero).count();
  Combinations result = Combinations::Zero(gaugeDirections, count);
  for (std::size_t a = 0; a < live.size(); ++a) {
    result.row(live[a]) =
        eigen.eigenvectors().row(static_cast<int>(a)).head(count) / std::sqrt(scale[static_cast<std::size_t>(live[a])]);
  }
  return result;
}

/// The combinations of generators that change errors by less than `noticed` of their scale, and their number less those
/// that move nothing at all: among the generators of a single vertex, say, there are more than it has directions.
int freeDirections(const Products& products, double noticed, Combinations& unseen) {
  // Generators that move nothing (a roll in the plane) are left out; the others are scaled to compare with each other.
  std::vector<int> live;
  for (int k = 0; k < gaugeDirections; ++k) {
    if (products.scale[static_cast<std::size_t>(k)] > 0.0) live.push_back(k);
  }
  if (live.empty()) return 0;
  const Eigen::Map<const Generators, 0, Eigen::OuterStride<padded>> square(products.square.data());
  const Eigen::Matrix<double, gaugeDirections, 1> lengths = products.gram.diagonal();
  unseen = nullSpace(square, products.scale, live, noticed);
  const auto motionless = nullSpace(products.gram, {lengths.data(), gaugeDirections}, live, 1e-13).cols();
  return std::max(0, static_cast<int>(unseen.cols() - motionless));
}

/// What adding edges reads.
struct EdgeSource {
  const Problem& problem;
  const std::vector<std::int64_t>& begin;
  const std::vector<double>& generators;
  const std::vector<int>& componentOf;
};

/// part ← J G, rows × 8.
template <typename L>
inline void multiplyBlock(const double* J, const double* generators, int rows, int columns, double* part) {
  for (int r = 0; r < rows; ++r) {
    L sum(0.0);
    for (int c = 0; c < columns; ++c) {
      L generator;
      detail::loadLanes(generators + c * padded, generator);
      sum += L(J[(c * rows + r) * Panel::lanes]) * generator;
    }
    detail::storeLanes(sum, part + r * padded);
  }
}

/// scale += the squares of each generator's column of part, rows × 8.
template <typename L>
inline void addSquares(const double* part, int rows, double* scale) {
  L sum;
  detail::loadLanes(scale, sum);
  for (int r = 0; r < rows; ++r) {
    L row;
    detail::loadLanes(part + r * padded, row);
    sum += row * row;
  }
  detail::storeLanes(sum, scale);
}

/// square += movedᵀ moved, moved rows × 8.
template <typename L>
inline void addSquare(const double* moved, int rows, double* square) {
  for (int a = 0; a < gaugeDirections; ++a) {
    L sum;
    detail::loadLanes(square + a * padded, sum);
    for (int r = 0; r < rows; ++r) {
      L row;
      detail::loadLanes(moved + r * padded, row);
      sum += L(moved[r * padded + a]) * row;
    }
    detail::storeLanes(sum, square + a * padded);
  }
}

/// Adds the J G of edges first … first + count − 1, which lie in the panel, to their components. `scratch` is memory
/// for twice rows × 8 numbers.
template <typename L>
inline void addPanel(const EdgeSource& source, const EdgeBatch& batch, int first, int count, const EdgeShape& shape,
                     const Panel& panel, double* scratch, Products* products) {
  const int rows = shape.rows;
  double* const moved = scratch;
  double* const part = scratch + rows * padded;
  for (int i = 0; i < count; ++i) {
    const auto slots = batch.slots(first + i);
    Products* target = nullptr;
    for (std::size_t role = 0; role < slots.size(); ++role) {
      const std::int64_t at = source.begin[static_cast<std::size_t>(slots[role])];
      if (at < 0) continue;
      const int columns = shape.columns[role];
      double* const own = target == nullptr ? moved : part;
      multiplyBlock<L>(
          panel.jacobian[role] + std::int64_t{i / Panel::lanes} * columns * rows * Panel::lanes + i % Panel::lanes,
          source.generators.data() + at, rows, columns, own);
      target = products + source.componentOf[static_cast<std::size_t>(source.problem.variableOfSlot(slots[role]))];
      addSquares<L>(own, rows, target->scale.data());
      for (int k = 0; own != moved && k < rows * padded; ++k) moved[k] += part[k];
    }
    if (target != nullptr) addSquare<L>(moved, rows, target->square.data());
  }
}

QUIVER_BATCH_LOOP_AVX2 void addPanelAvx2(const EdgeSource& source, const EdgeBatch& batch, int first, int count,
                                         const EdgeShape& shape, const Panel& panel, double* scratch,
                                         Products* products) {
  addPanel<Lanes<isa::Avx2>>(source, batch, first, count, shape, panel, scratch, products);
}
QUIVER_BATCH_LOOP_GENERIC void addPanelGeneric(const EdgeSource& source, const EdgeBatch& batch, int first, int count,
                                               const EdgeShape& shape, const Panel& panel, double* scratch,
                                               Products* products) {
  addPanel<Lanes<isa::Generic>>(source, batch, first, count, shape, panel, scratch, products);
}

/// Adds a part of the edges, one of `pieces`, to products of its own.
void addPiece(const EdgeSource& source, std::int64_t piece, std::int64_t pieces, std::vector<Products>& products) {
  const bool wide = detectInstructionSet() != InstructionSet::generic;
  std::vector<std::int32_t> ids(Panel::capacity);
  std::vector<double> scratch;
  for (int b = 0; b < source.problem.batches(); ++b) {
    const EdgeBatch& batch = source.problem.batch(b);
    const int step = batch.uniform() ? Panel::capacity : 1;
    const std::int64_t chunks = (batch.size() + step - 1) / step;
    const auto begin = static_cast<int>(piece * chunks / pieces) * step;
    const int end = std::min(batch.size(), static_cast<int>((piece + 1) * chunks / pieces) * step);
    if (begin >= end) continue;
    PanelBuffer buffer(batch.largestShape());
    for (int first = begin; first < end; first += step) {
      const int count = std::min(step, end - first);
      std::iota(ids.begin(), ids.end(), first);
      batch.linearize(source.problem.state(), {ids.data(), static_cast<std::size_t>(count)}, buffer.panel());
      const EdgeShape shape = batch.shape(first);
      scratch.resize(2 * static_cast<std::size_t>(shape.rows * padded));
      (wide ? addPanelAvx2 : addPanelGeneric)(source, batch, first, count, shape, buffer.panel(), scratch.data(),
                                              products.data());
    }
  }
}

/// Whether the first edges of a problem of one variable hold all its directions beyond doubt, as a few pixels of known
/// points do for the pose of one camera: the pivots of their JᵀJ, scaled to a unit diagonal, are clearly positive.
bool clearlyHeld(const Problem& problem) {
  constexpr int few = 2 * Panel::lanes;
  const EdgeBatch& batch = problem.batch(0);
  if (!batch.uniform()) return false;
  const EdgeShape shape = batch.largestShape();
  const int count = std::min(batch.size(), few);
  const int dimension = problem.dimension(0);
  PanelBuffer buffer(shape);
  std::int32_t ids[few];
  std::iota(ids, ids + count, 0);
  batch.linearize(problem.state(), {ids, static_cast<std::size_t>(count)}, buffer.panel());
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(dimension, dimension);
  for (int i = 0; i < count; ++i) {
    const auto slots = batch.slots(i);
    for (std::size_t role = 0; role < slots.size(); ++role) {
      if (problem.variableOfSlot(slots[role]) != 0) continue;
      const double* const J =
          buffer.panel().jacobian[role] + i / Panel::lanes * dimension * shape.rows * Panel::lanes + i % Panel::lanes;
      const auto entry = [&](int r, int c) { return J[(c * shape.rows + r) * Panel::lanes]; };
      for (int a = 0; a < dimension; ++a) {
        for (int b = 0; b <= a; ++b) {
          for (int r = 0; r < shape.rows; ++r) square(a, b) += entry(r, a) * entry(r, b);
        }
      }
    }
  }
  const Eigen::VectorXd scale = square.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> factor(scale.asDiagonal() * square * scale.asDiagonal());
  return factor.info() == Eigen::Success && factor.matrixLLT().diagonal().minCoeff() > std::sqrt(clearlyNoticed);
}

/// Adds one vertex's GᵀG to its component.
void addVertex(const double* generators, int dimension, Products& products) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, gaugeDirections, Eigen::RowMajor>;
  const Eigen::Map<const Rows, 0, Eigen::OuterStride<padded>> G(generators, dimension, gaugeDirections);
  products.gram += G.transpose() * G;
}

}  // namespace

std::vector<ComponentGauge> findGauges(const Problem& problem) {
  if (problem.variables() == 1 && problem.batches() > 0 && !problem.anyHeldDirections() && clearlyHeld(problem)) {
    ComponentGauge held;
    held.anchor = 0;
    held.variables = {0};
    return {held};
  }
  std::vector<int> componentOf;
  std::vector<ComponentGauge> gauges = components(problem, componentOf);
  std::vector<std::int64_t> begin;
  const std::vector<double> generators = slotGenerators(problem, begin, componentOf, gauges);
  std::vector<Products> products(gauges.size());
  for (int variable = 0; variable < problem.variables(); ++variable) {
    const std::int64_t at = begin[static_cast<std::size_t>(problem.slotOfVariable(variable))];
    if (at < 0) continue;
    addVertex(generators.data() + at, problem.dimension(variable),
              products[static_cast<std::size_t>(componentOf[static_cast<std::size_t>(variable)])]);
  }
  const EdgeSource source{problem, begin, generators, componentOf};
  // Pieces each have products of all components.
  const std::int64_t pieces =
      gauges.size() > 16 ? 1 : std::clamp<std::int64_t>(problem.edges() / pieceEdges, 1, mostPieces);
  std::vector<std::vector<Products>> parts(static_cast<std::size_t>(pieces - 1), std::vector<Products>(gauges.size()));
  parallelFor(pieces, problem.threads(), [&](std::int64_t piece) {
    addPiece(source, piece, pieces, piece == 0 ? products : parts[static_cast<std::size_t>(piece - 1)]);
  });
  for (const std::vector<Products>& part : parts) {
    for (std::size_t i = 0; i < gauges.size(); ++i) products[i].add(part[i]);
  }
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    gauges[i].anchor = findAnchor(problem, gauges[i].variables);
    Combinations unseen(gaugeDirections, 0);
    gauges[i].free = gauges[i].tested ? freeDirections(products[i], unnoticed, unseen) : 0;
    if (gauges[i].free > 0)
      gauges[i].holds = detail::chooseHolds(problem, gauges[i], products[i].gram, unseen, generators, begin);
  }
  return gauges;
}

}  // namespace quiver
