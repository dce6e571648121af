#include <quiver/solvers/elimination/kernels/elimination_level.h>

#include <algorithm>

#include <quiver/core/util/error.h>

namespace quiver::detail {

const EliminationKernels& eliminationKernels(KernelLevel level) {
  const std::vector<KernelLevel> levels = availableKernelLevels();
  if (level == KernelLevel::automatic) level = levels.back();
  if (std::find(levels.begin(), levels.end(), level) == levels.end())
    throw LogicError("this processor or build has no kernels of the demanded level");
  if (level == KernelLevel::avx512) return *avx512EliminationKernels();
  if (level == KernelLevel::avx2) return *avx2EliminationKernels();
  return *genericEliminationKernels();
}

}  // namespace quiver::detail
