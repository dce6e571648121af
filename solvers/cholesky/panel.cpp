#include <quiver/solvers/cholesky/panel.h>

#include <algorithm>
#include <array>
#include <atomic>

#include <quiver/core/util/parallel.h>
#include <quiver/core/util/progress.h>

namespace quiver::detail {
namespace {

/// Rows of a strip where threads share the work: whole register tiles, and whole chunks of columns.
constexpr int stripRows = 2 * chunkColumns;
constexpr int mostStrips = 64;
/// Columns whose products are subtracted together.
constexpr int depthColumns = 96;

/// Left-looking Cholesky by tiles: chunks of columns by strips of rows. A tile subtracts the products of all chunks to
/// its left at once, then is divided by the diagonal of its chunk. Tiles are taken in the order of chunks, the diagonal
/// first, and wait for the tiles they read, all of which were taken before; so while one thread factors a diagonal,
/// others are at the products of the next tiles.
class TiledFactor {
 public:
  TiledFactor(const KernelTable& kernels, const Panel& panel, int threads, const StopCondition& stop)
      : kernels_(kernels), panel_(panel), stop_(stop), threads_(threads), height_(panel.rows) {
    if (threads_ > 1)
      height_ = stripRows * std::max(1, (panel.rows + stripRows * mostStrips - 1) / (stripRows * mostStrips));
    strips_ = (panel.rows + height_ - 1) / height_;
  }

  PanelFailure run() {
    int tasks = 0;
    for (int chunk = 0; chunk < chunks(); ++chunk) tasks += tasksOf(chunk);
    parallelForWorkers(tasks, threads_, threads_, [this](std::int64_t task, int) {
      int chunk = 0;
      auto left = static_cast<int>(task);
      while (left >= tasksOf(chunk)) left -= tasksOf(chunk++);
      if (left == 0) {
        factorDiagonal(chunk);
      } else {
        finishTile(chunk, below(chunk) / height_ + left - 1);
      }
    });
    return failure_;
  }

 private:
  int chunks() const { return (panel_.columns + chunkColumns - 1) / chunkColumns; }
  static int begin(int chunk) { return chunk * chunkColumns; }
  int width(int chunk) const { return std::min(chunkColumns, panel_.columns - begin(chunk)); }
  /// The first row below the diagonal block of a chunk.
  int below(int chunk) const { return begin(chunk) + (width(chunk) + 7) / 8 * 8; }
  int tasksOf(int chunk) const { return below(chunk) < panel_.rows ? 1 + strips_ - below(chunk) / height_ : 1; }

  void subtractProducts(int chunk, int firstRow, int lastRow) const {
    for (int k = 0; k < begin(chunk); k += depthColumns) {
      kernels_.updatePanel(panel_.values, panel_.stride, k, std::min(depthColumns, begin(chunk) - k), begin(chunk),
                           begin(chunk) + width(chunk), firstRow, lastRow);
    }
  }

  void factorDiagonal(int chunk) {
    // The strip that holds its rows.
    if (!finished_[static_cast<std::size_t>(begin(chunk) / height_)].await(chunk, ended_)) return;
    PanelFailure failure;
    failure.stopped = chunk > 0 && stop_.reached();
    if (!failure.stopped) {
      subtractProducts(chunk, begin(chunk), below(chunk));
      failure.column = kernels_.factorDiagonal(panel_.values, panel_.stride, begin(chunk), width(chunk), panel_.inverse,
                                               &failure.pivot);
      if (failure.column >= 0) failure.column += begin(chunk);
    }
    if (failure.stopped || failure.column >= 0) {
      failure_ = failure;
      ended_.store(true, std::memory_order_release);
      return;
    }
    diagonals_.reach(chunk + 1);
  }

  void finishTile(int chunk, int strip) {
    const auto at = static_cast<std::size_t>(strip);
    const int first = std::max(below(chunk), strip * height_);
    const int last = std::min(panel_.rows, (strip + 1) * height_);
    if (!finished_[at].await(chunk, ended_)) return;
    if (!finished_[static_cast<std::size_t>(begin(chunk) / height_)].await(chunk, ended_)) return;
    subtractProducts(chunk, first, last);
    if (!diagonals_.await(chunk + 1, ended_)) return;
    kernels_.solveRows(panel_.values, panel_.stride, begin(chunk), width(chunk), first, last, panel_.inverse);
    finished_[at].reach(chunk + 1);
  }

  const KernelTable& kernels_;
  const Panel& panel_;
  const StopCondition& stop_;
  int threads_;
  int height_;
  int strips_;
  /// Chunks whose diagonal is factored, and of each strip the chunks whose tile is finished.
  Progress diagonals_;
  std::array<Progress, mostStrips> finished_;
  std::atomic<bool> ended_{false};
  PanelFailure failure_;
};

}  // namespace

PanelFailure factorPanel(const KernelTable& kernels, const Panel& panel, int threads, const StopCondition& stop) {
  return TiledFactor(kernels, panel, threads, stop).run();
}

}  // namespace quiver::detail
