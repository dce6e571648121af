#include <quiver/solvers/assembly/diagonal_gather.h>

#include <quiver/solvers/assembly/lane_products.h>

namespace quiver {

void DiagonalGather::run(int begin, int end) const {
  for (int variable = begin; variable < end; ++variable) {
    switch (const int dimension = problem.dimension(variable)) {
      case 1:
        gather<1>(variable);
        break;
      case 2:
        gather<2>(variable);
        break;
      case 3:
        gather<3>(variable);
        break;
      case 6:
        gather<6>(variable);
        break;
      case 7:
        gather<7>(variable);
        break;
      case 9:
        gather<9>(variable);
        break;
      default:
        gatherAny(variable, dimension);
    }
  }
}

template <int D>
void DiagonalGather::gather(int variable) const {
  constexpr int padded = LaneProducts::paddedSize(D);
  const std::int64_t begin = plan.gatherBegin(variable);
  const std::int64_t end = plan.gatherBegin(variable + 1);
  double total[padded];
  const double* first = records + plan.gathered(begin);
  for (int k = 0; k < padded; ++k) total[k] = first[k];
  for (std::int64_t i = begin + 1; i < end; ++i) {
    const double* record = records + plan.gathered(i);
    for (int k = 0; k < padded; ++k) total[k] += record[k];
  }
  double* block = matrix.block(matrix.pattern().columnBegin(position[static_cast<std::size_t>(variable)]));
  const std::int64_t offset = problem.offset(variable);
  for (int r = 0, at = 0; r < D; ++r) {
    diagonal[static_cast<std::size_t>(offset + r)] = total[at];
    for (int c = r; c < D; ++c, ++at) block[r * D + c] = block[c * D + r] = total[at];
  }
  for (int r = 0; r < D; ++r) gradient[static_cast<std::size_t>(offset + r)] = total[D * (D + 1) / 2 + r];
  holdDirections(variable, D, block);
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
  double* block = matrix.block(matrix.pattern().columnBegin(position[static_cast<std::size_t>(variable)]));
  const std::int64_t offset = problem.offset(variable);
  int at = 0;
  for (int r = 0; r < dimension; ++r) {
    diagonal[static_cast<std::size_t>(offset + r)] = total[at];
    for (int c = r; c < dimension; ++c, ++at) block[r * dimension + c] = block[c * dimension + r] = total[at];
  }
  for (int r = 0; r < dimension; ++r) gradient[static_cast<std::size_t>(offset + r)] = total[at + r];
  holdDirections(variable, dimension, block);
}

void DiagonalGather::holdDirections(int variable, int dimension, double* block) const {
  const std::uint64_t held = problem.heldDirections(variable);
  for (int r = 0; held != 0 && r < dimension && r < 64; ++r) {
    if (!(held >> r & 1)) continue;
    block[r * dimension + r] = 1.0;
    diagonal[static_cast<std::size_t>(problem.offset(variable) + r)] = 1.0;
  }
}

}  // namespace quiver
