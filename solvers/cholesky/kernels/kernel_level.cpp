#include <quiver/solvers/cholesky/kernels/kernel_level.h>

#include <quiver/core/util/error.h>
#include <quiver/solvers/cholesky/kernels/kernel_table.h>

namespace quiver::detail {
namespace {

const KernelTable* tableOf(KernelLevel level) {
#if defined(__x86_64__) && defined(__GNUC__)
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl");
#else
  const bool avx2 = false;
  const bool avx512 = false;
#endif
  if (level == KernelLevel::avx512) return avx512 ? avx512Kernels() : nullptr;
  if (level == KernelLevel::avx2) return avx2 ? avx2Kernels() : nullptr;
  return genericKernels();
}

}  // namespace

std::vector<KernelLevel> availableKernelLevels() {
  std::vector<KernelLevel> levels;
  for (const KernelLevel level : {KernelLevel::generic, KernelLevel::avx2, KernelLevel::avx512}) {
    if (tableOf(level) != nullptr) levels.push_back(level);
  }
  return levels;
}

const KernelTable& kernelTable(KernelLevel level) {
  if (level == KernelLevel::automatic) level = availableKernelLevels().back();
  const KernelTable* table = tableOf(level);
  if (table == nullptr) throw LogicError("this processor or build has no kernels of the demanded level");
  return *table;
}

}  // namespace quiver::detail
