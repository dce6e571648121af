// Solving a graph again whose structure is that of the last call: what is allocated, and what setting up costs beside
// the solve. One thread, so that every allocation is the solve's own.
//   quiver_bench_resolve [--json FILE] [--rounds N] [GRAPH.g2o...]
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

#include <quiver/core/graph/estimates.h>
#include <quiver/quiver.h>

#include "peers/measure.h"

namespace {

std::atomic<long> allocations{0};
std::atomic<long> allocatedBytes{0};

void* counted(std::size_t bytes, std::size_t alignment) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  allocatedBytes.fetch_add(static_cast<long>(bytes), std::memory_order_relaxed);
  const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
  void* memory = alignment > alignof(std::max_align_t) ? std::aligned_alloc(alignment, rounded) : std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) { return counted(bytes, 1); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

using namespace quiver;

namespace {

struct Call {
  double seconds = 0.0;
  double setup = 0.0;
  long allocations = 0;
  long bytes = 0;
  std::size_t iterations = 0;
};

Call call(Optimizer& optimizer, Graph& graph) {
  Call result;
  const long before = allocations;
  const long bytesBefore = allocatedBytes;
  const Summary& summary = optimizer.optimize(graph);
  result.allocations = allocations - before;
  result.bytes = allocatedBytes - bytesBefore;
  result.seconds = summary.seconds.total;
  result.setup = summary.seconds.compile + summary.seconds.analyze;
  result.iterations = summary.iterations.size();
  return result;
}

}  // namespace

int main(int count, char** words) {
  const bench::Arguments arguments(count, words, {"intel", "M3500", "parking-garage", "sphere2500", "sphere_noisy"});
  const auto registry = builtinRegistry();
  bench::JsonRows json;
  fmt::print("{:<16} {:>10} {:>12} {:>12} | {:>10} {:>12} {:>12} {:>10} {:>8}\n", "graph", "first ms", "allocations",
             "bytes", "again ms", "allocations", "bytes", "set-up ms", "share");
  for (const std::string& file : arguments.graphs) {
    const Graph start = readGraph(file, registry);
    Graph graph(start);
    Optimizer optimizer({.maxIterations = 5, .threads = 1});
    const Call first = call(optimizer, graph);
    std::vector<double> seconds;
    std::vector<double> setups;
    Call again;
    for (int round = 0; round < arguments.rounds; ++round) {
      copyEstimates(start, graph);
      again = call(optimizer, graph);
      seconds.push_back(again.seconds);
      setups.push_back(again.setup);
    }
    const double share = bench::median(setups) / bench::median(seconds);
    const std::string name = std::filesystem::path(file).stem().string();
    fmt::print("{:<16} {:>10.3f} {:>12} {:>12} | {:>10.3f} {:>12} {:>12} {:>10.3f} {:>7.1f}%\n", name,
               1e3 * first.seconds, first.allocations, first.bytes, 1e3 * bench::median(seconds), again.allocations,
               again.bytes, 1e3 * bench::median(setups), 100.0 * share);
    json.begin(name);
    json.add("first_seconds", first.seconds);
    json.add("seconds", bench::median(seconds));
    json.add("setup_seconds", bench::median(setups));
    json.add("setup_share", share);
    json.add("allocations", static_cast<double>(again.allocations));
    json.add("allocated_bytes", static_cast<double>(again.bytes));
    json.add("iterations", static_cast<double>(again.iterations));
  }
  json.write(arguments.json);
}
