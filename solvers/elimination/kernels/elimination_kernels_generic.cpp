#define QUIVER_KERNEL_WIDTH 2
#define QUIVER_KERNEL_NAME "generic"
#include <quiver/solvers/elimination/kernels/kernel_body.h>

namespace quiver::detail {

const EliminationKernels* genericEliminationKernels() { return &kernels; }

}  // namespace quiver::detail
