#if defined(__AVX512F__) && defined(__AVX512DQ__)

#  define QUIVER_KERNEL_WIDTH 8
#  define QUIVER_KERNEL_NAME "avx512"
#  include <quiver/solvers/elimination/kernels/kernel_body.h>

namespace quiver::detail {

const EliminationKernels* avx512EliminationKernels() { return &kernels; }

}  // namespace quiver::detail

#else

#  include <quiver/solvers/elimination/kernels/kernel_table.h>

namespace quiver::detail {

const EliminationKernels* avx512EliminationKernels() { return nullptr; }

}  // namespace quiver::detail

#endif
