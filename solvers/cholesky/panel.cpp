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
  TiledFactor(const KernelTable& kernels, const Panel& panel, int threads, const StopCondition& stop,
              UpcomingMemory& upcoming)
      : kernels_(kernels), panel_(panel), stop_(stop), upcoming_(upcoming), threads_(threads), height_(panel.rows) {
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

  /// Waits until the chunks before `chunk` are finished in a strip; false if they never will be.
  bool awaitStrip(int strip, int chunk) { return finished_[static_cast<std::size_t>(strip)].await(chunk, ended_); }

  /// Subtracts products from rows of a strip as the chunks to the left come to be finished there, and in the strip that
  /// holds the chunk's own rows. Returns false if they never will be.
  bool subtractProducts(int chunk, int strip, int firstRow, int lastRow) {
    const int own = begin(chunk) / height_;
    for (int k = 0; k < begin(chunk); k += depthColumns) {
      const int depth = std::min(depthColumns, begin(chunk) - k);
      const int needed = (k + depth) / chunkColumns;
      if (!awaitStrip(strip, needed) || !awaitStrip(own, needed)) return false;
      kernels_.updatePanel(panel_.values, panel_.stride, k, depth, begin(chunk), begin(chunk) + width(chunk), firstRow,
                           lastRow, &upcoming_);
    }
    return true;
  }

  void factorDiagonal(int chunk) {
    PanelFailure failure;
    failure.stopped = chunk > 0 && stop_.reached();
    if (!failure.stopped) {
      if (!subtractProducts(chunk, begin(chunk) / height_, begin(chunk), below(chunk))) return;
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
    if (!subtractProducts(chunk, strip, first, last)) return;
    if (!diagonals_.await(chunk + 1, ended_)) return;
    kernels_.solveRows(panel_.values, panel_.stride, begin(chunk), width(chunk), first, last, panel_.inverse);
    finished_[at].reach(chunk + 1);
  }

  const KernelTable& kernels_;
  const Panel& panel_;
  const StopCondition& stop_;
  UpcomingMemory& upcoming_;
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

PanelFailure factorPanel(const KernelTable& kernels, const Panel& panel, int threads, const StopCondition& stop,
                         UpcomingMemory& upcoming) {
  return TiledFactor(kernels, panel, threads, stop, upcoming).run();
}

}  // namespace quiver::detail
