#if defined(__AVX2__) && defined(__FMA__)

#  define QUIVER_KERNEL_WIDTH 4
#  define QUIVER_KERNEL_NAME "avx2"
#  include <quiver/solvers/elimination/kernels/kernel_body.h>

namespace quiver::detail {

const EliminationKernels* avx2EliminationKernels() { return &kernels; }

}  // namespace quiver::detail

#else

#  include <quiver/solvers/elimination/kernels/kernel_table.h>

namespace quiver::detail {

const EliminationKernels* avx2EliminationKernels() { return nullptr; }

}  // namespace quiver::detail

#endif
