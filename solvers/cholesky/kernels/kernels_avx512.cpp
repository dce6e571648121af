#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)

#  define QUIVER_KERNEL_WIDTH 8
#  define QUIVER_KERNEL_NAME "avx512"
#  include <quiver/solvers/cholesky/kernels/kernel_body.h>

namespace quiver::detail {

const KernelTable* avx512Kernels() { return &kernels; }

}  // namespace quiver::detail

#else

#  include <quiver/solvers/cholesky/kernels/kernel_table.h>

namespace quiver::detail {

const KernelTable* avx512Kernels() { return nullptr; }

}  // namespace quiver::detail

#endif
