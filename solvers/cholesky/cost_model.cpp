#include <quiver/solvers/cholesky/cost_model.h>

#include <array>

#include <quiver/solvers/cholesky/kernels/kernel_table.h>

namespace quiver::detail {
namespace {

struct LeafCosts {
  double column;
  double block;
  double pair;
};

constexpr std::array<LeafCosts, largestLeafDimension + 1> leafCosts{{{0, 0, 0},
                                                                     {15, 1.0, 1.0},
                                                                     {20, 1.5, 1.6},
                                                                     {30, 2.0, 2.7},
                                                                     {40, 4.0, 4.5},
                                                                     {55, 6.0, 9.0},
                                                                     {70, 8.0, 12.5},
                                                                     {90, 11.0, 18.0},
                                                                     {110, 14.0, 24.0},
                                                                     {140, 20.0, 45.0}}};

}  // namespace

double frontNanoseconds(double columns, double rows) {
  const double arithmetic =
      (columns * columns * columns / 3.0 + columns * columns * rows) / 50.0 + columns * rows * rows / 55.0;
  const double movement = 0.21 * rows * rows + 1.4 * columns * (0.5 * columns + rows);
  return 150.0 + 8.0 * columns + arithmetic + movement;
}

double leafColumnNanoseconds(int b, double below) {
  const LeafCosts& costs = leafCosts[b];
  return costs.column + costs.block * below + costs.pair * 0.5 * below * (below + 1.0);
}

double leafUpdateNanoseconds(double rows) { return 0.06 * rows * rows; }

}  // namespace quiver::detail
