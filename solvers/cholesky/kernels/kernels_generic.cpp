#define QUIVER_KERNEL_WIDTH 2
#define QUIVER_KERNEL_NAME "generic"
#include <quiver/solvers/cholesky/kernels/kernel_body.h>

namespace quiver::detail {

const KernelTable* genericKernels() { return &kernels; }

}  // namespace quiver::detail
