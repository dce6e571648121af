#pragma once

#include <quiver/core/util/function_ref.h>

namespace quiver {

/// Runs work that uses a foreign library with hidden state of its own (a sequence of random numbers, say): of all such
/// work in the process one piece runs at a time, others wait. Must not be called within itself.
void oneAtATime(FunctionRef<void()> work);

}  // namespace quiver
