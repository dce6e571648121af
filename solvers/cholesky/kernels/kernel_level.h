#pragma once

#include <vector>

namespace quiver::detail {

struct KernelTable;

/// The instruction sets the numeric kernels exist for.
enum class KernelLevel { automatic, generic, avx2, avx512 };

/// The kernels of a level; automatic is the highest one that this processor runs. Throws LogicError if it cannot run
/// the level.
const KernelTable& kernelTable(KernelLevel level);

/// All levels this processor runs, lowest first.
std::vector<KernelLevel> availableKernelLevels();

}  // namespace quiver::detail
