// The numeric kernels for one instruction set. A translation unit defines QUIVER_KERNEL_WIDTH (doubles a vector) and
// QUIVER_KERNEL_NAME, is compiled with that set's flags, and includes this file once: everything below is local to it.

#include <quiver/solvers/cholesky/kernels/kernel_table.h>

namespace quiver::detail {
namespace {

#include <quiver/solvers/cholesky/kernels/kernel_vector.h>
//
#include <quiver/solvers/cholesky/kernels/kernel_dense.h>
//
#include <quiver/solvers/cholesky/kernels/kernel_update.h>
//
#include <quiver/solvers/cholesky/kernels/kernel_assembly.h>
//
#include <quiver/solvers/cholesky/kernels/kernel_leaf.h>

constexpr KernelTable kernels{QUIVER_KERNEL_NAME,
                              factorDiagonal,
                              solveRows,
                              updatePanel,
                              formUpdate,
                              addChild,
                              forward,
                              backward,
                              {nullptr, leafLoad<1>, leafLoad<2>, leafLoad<3>, leafLoad<4>, leafLoad<5>, leafLoad<6>,
                               leafLoad<7>, leafLoad<8>, leafLoad<9>},
                              {nullptr, leafFactor<1>, leafFactor<2>, leafFactor<3>, leafFactor<4>, leafFactor<5>,
                               leafFactor<6>, leafFactor<7>, leafFactor<8>, leafFactor<9>},
                              {nullptr, leafForward<1>, leafForward<2>, leafForward<3>, leafForward<4>, leafForward<5>,
                               leafForward<6>, leafForward<7>, leafForward<8>, leafForward<9>},
                              {nullptr, leafBackward<1>, leafBackward<2>, leafBackward<3>, leafBackward<4>,
                               leafBackward<5>, leafBackward<6>, leafBackward<7>, leafBackward<8>, leafBackward<9>}};

}  // namespace
}  // namespace quiver::detail
