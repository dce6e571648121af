#pragma once

#include <cstdint>

#include <quiver/core/util/stop_condition.h>
#include <quiver/solvers/cholesky/kernels/kernel_table.h>

namespace quiver::detail {

/// The columns of a dense symmetric matrix that are eliminated together, and all their rows. Column-major; `rows` and
/// `stride` are multiples of 8; row i ≥ columns lies at i − columns + ceil8(columns); padding is zero.
struct Panel {
  double* values;
  std::int64_t stride;
  int columns;
  int rows;
  double* inverse;  // reciprocals of L's diagonal, one for each column
};

/// How factorPanel ended: `column` is the first whose pivot is not positive and finite, −1 if there is none.
struct PanelFailure {
  int column = -1;
  double pivot = 0.0;
  bool stopped = false;
};

/// Factors the panel in place on at most `threads` threads; the same bits for any number. `stop` is polled between
/// chunks of columns. `upcoming` is empty for several threads.
PanelFailure factorPanel(const KernelTable& kernels, const Panel& panel, int threads, const StopCondition& stop,
                         UpcomingMemory& upcoming);

}  // namespace quiver::detail
