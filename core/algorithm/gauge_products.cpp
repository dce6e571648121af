#include <quiver/core/algorithm/gauge_products.h>

#include <algorithm>
#include <numeric>

#include <quiver/core/problem/lane_records.h>
#include <quiver/core/util/parallel.h>
#include <quiver/geometry/scalar/isa.h>

namespace quiver::detail {
namespace {

constexpr int padded = gaugeRow;
/// Edges a piece, at least; pieces at most. An edge that runs by itself may cost anything and counts for many.
constexpr std::int64_t pieceEdges = 4096;
constexpr std::int64_t singleEdge = 64;
constexpr std::int64_t mostPieces = 16;

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
inline void addPanel(const GaugeSource& source, const EdgeBatch& batch, int first, int count, const EdgeShape& shape,
                     const Panel& panel, double* scratch, ComponentProducts* products) {
  const int rows = shape.rows;
  double* const moved = scratch;
  double* const part = scratch + rows * padded;
  for (int i = 0; i < count; ++i) {
    const auto slots = batch.slots(first + i);
    ComponentProducts* target = nullptr;
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

QUIVER_BATCH_LOOP_AVX2 void addPanelAvx2(const GaugeSource& source, const EdgeBatch& batch, int first, int count,
                                         const EdgeShape& shape, const Panel& panel, double* scratch,
                                         ComponentProducts* products) {
  addPanel<Lanes<isa::Avx2>>(source, batch, first, count, shape, panel, scratch, products);
}
QUIVER_BATCH_LOOP_GENERIC void addPanelGeneric(const GaugeSource& source, const EdgeBatch& batch, int first, int count,
                                               const EdgeShape& shape, const Panel& panel, double* scratch,
                                               ComponentProducts* products) {
  addPanel<Lanes<isa::Generic>>(source, batch, first, count, shape, panel, scratch, products);
}

/// Adds a part of the edges, one of `pieces`, to products of its own.
void addPiece(const GaugeSource& source, std::int64_t piece, std::int64_t pieces,
              std::vector<ComponentProducts>& products) {
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
    PanelBuffer buffer(batch.largestShape(), true, step);
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

}  // namespace

void addEdges(const GaugeSource& source, std::vector<ComponentProducts>& products) {
  std::int64_t edges = 0;
  for (int b = 0; b < source.problem.batches(); ++b) {
    const EdgeBatch& batch = source.problem.batch(b);
    edges += batch.rowBytes() > 0 ? batch.size() : singleEdge * batch.size();
  }
  // Pieces each have products of all components.
  const std::int64_t pieces = products.size() > 16 ? 1 : std::clamp<std::int64_t>(edges / pieceEdges, 1, mostPieces);
  std::vector<std::vector<ComponentProducts>> parts(static_cast<std::size_t>(pieces - 1),
                                                    std::vector<ComponentProducts>(products.size()));
  parallelFor(pieces, source.problem.threads(), [&](std::int64_t piece) {
    addPiece(source, piece, pieces, piece == 0 ? products : parts[static_cast<std::size_t>(piece - 1)]);
  });
  for (const std::vector<ComponentProducts>& part : parts) {
    for (std::size_t i = 0; i < products.size(); ++i) products[i].add(part[i]);
  }
}

}  // namespace quiver::detail
