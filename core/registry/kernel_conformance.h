#pragma once

#include <string>

#include <quiver/core/graph/robust_kernel.h>

namespace quiver {

/// The first promise of RobustKernelType that a kernel breaks, in words; empty if it keeps them. Looks at squared
/// errors from 0 to 1e8 and widths from 0.1 to 100.
std::string brokenKernelPromise(const RobustKernelType& type);

}  // namespace quiver
