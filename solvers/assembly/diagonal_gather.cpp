#include <quiver/solvers/assembly/diagonal_gather.h>

#include <algorithm>

#include <quiver/solvers/assembly/lane_products.h>

namespace quiver {

namespace {

/// Variables come in the order of their ids, their blocks in that of elimination: no hardware sees what comes next.
constexpr int ahead = 6;
constexpr int line = 8;

}  // namespace

void DiagonalGather::run(int begin, int end) const {
  for (int first = begin, last = begin; first < end; first = last) {
    const int dimension = problem.dimension(first);
    while (last < end && problem.dimension(last) == dimension) ++last;
    switch (dimension) {
      case 1:
        gather<1>(first, last);
        break;
      case 2:
        gather<2>(first, last);
        break;
      case 3:
        gather<3>(first, last);
        break;
      case 6:
        gather<6>(first, last);
        break;
      case 7:
        gather<7>(first, last);
        break;
      case 9:
        gather<9>(first, last);
        break;
      default:
        for (int variable = first; variable < last; ++variable) gatherAny(variable, dimension);
    }
  }
  if (!problem.anyHeldDirections()) return;
  for (int variable = begin; variable < end; ++variable) holdDirections(variable);
}

template <int D>
QUIVER_TARGET_PREFETCH void DiagonalGather::gather(int first, int last) const {
  constexpr int size = LaneProducts::squareSize(D);
  double* const values = matrix.values().data();
  for (int variable = first; variable < last; ++variable) {
    if (variable + ahead < last) {
      const double* const record = records + plan.gathered(plan.gatherBegin(variable + ahead));
      double* const block = values + blocks[static_cast<std::size_t>(variable + ahead)];
      for (int k = 0; k < size; k += line) __builtin_prefetch(record + k);
      for (int k = 0; k < D * D; k += line) __builtin_prefetch(block + k, 1);
    }
    const std::int64_t begin = plan.gatherBegin(variable);
    const std::int64_t end = plan.gatherBegin(variable + 1);
    double total[size];
    const double* const one = records + plan.gathered(begin);
    for (int k = 0; k < size; ++k) total[k] = one[k];
    for (std::int64_t i = begin + 1; i < end; ++i) {
      const double* const record = records + plan.gathered(i);
      for (int k = 0; k < size; ++k) total[k] += record[k];
    }
    double* const block = values + blocks[static_cast<std::size_t>(variable)];
    const std::int64_t offset = problem.offset(variable);
    // First what is contiguous: a row of the triangle is the lower part of a column.
    double* const onDiagonal = diagonal.data() + offset;
#pragma GCC unroll 9
    for (int r = 0, at = 0; r < D; at += D - r++) {
      onDiagonal[r] = total[at];
#pragma GCC unroll 9
      for (int c = r; c < D; ++c) block[r * D + c] = total[at + c - r];
    }
#pragma GCC unroll 9
    for (int r = 0, at = 0; r < D; at += D - r++) {
#pragma GCC unroll 9
      for (int c = r + 1; c < D; ++c) block[c * D + r] = total[at + c - r];
    }
    double* const forces = gradient.data() + offset;
#pragma GCC unroll 9
    for (int r = 0; r < D; ++r) forces[r] = total[D * (D + 1) / 2 + r];
  }
}

void DiagonalGather::gatherAny(int variable, int dimension) const {
  const int size = LaneProducts::squareSize(dimension);
  const std::int64_t begin = plan.gatherBegin(variable);
  const std::int64_t end = plan.gatherBegin(variable + 1);
  // The first record is the vertex's alone: the sum is made there.
  double* total = records + plan.gathered(begin);
  for (std::int64_t i = begin + 1; i < end; ++i) {
    const double* record = records + plan.gathered(i);
    for (int k = 0; k < size; ++k) total[k] += record[k];
  }
  double* block = matrix.values().data() + blocks[static_cast<std::size_t>(variable)];
  const std::int64_t offset = problem.offset(variable);
  int at = 0;
  for (int r = 0; r < dimension; ++r) {
    diagonal[static_cast<std::size_t>(offset + r)] = total[at];
    for (int c = r; c < dimension; ++c, ++at) block[r * dimension + c] = block[c * dimension + r] = total[at];
  }
  for (int r = 0; r < dimension; ++r) gradient[static_cast<std::size_t>(offset + r)] = total[at + r];
}

void DiagonalGather::holdDirections(int variable) const {
  const int dimension = problem.dimension(variable);
  double* const block = matrix.values().data() + blocks[static_cast<std::size_t>(variable)];
  const std::uint64_t held = problem.heldDirections(variable);
  for (int r = 0; held != 0 && r < dimension && r < 64; ++r) {
    if (!(held >> r & 1)) continue;
    block[r * dimension + r] = 1.0;
    diagonal[static_cast<std::size_t>(problem.offset(variable) + r)] = 1.0;
  }
}

}  // namespace quiver
