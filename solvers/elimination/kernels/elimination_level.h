#pragma once

#include <quiver/solvers/cholesky/kernels/kernel_level.h>
#include <quiver/solvers/elimination/kernels/kernel_table.h>

namespace quiver::detail {

/// The kernels of a level; automatic is the highest one that this processor runs. Throws LogicError if it cannot run
/// the level.
const EliminationKernels& eliminationKernels(KernelLevel level = KernelLevel::automatic);

}  // namespace quiver::detail
