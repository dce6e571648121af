// Reading .g2o files: quiver on one and on two threads, against a reader made of string streams and heap objects.
//   quiver_bench_reading [--json FILE] [--rounds N] [GRAPH.g2o...]
#include <quiver/quiver.h>

#include "peers/measure.h"
#include "peers/stream_reader.h"

using namespace quiver;

int main(int count, char** words) {
  const bench::Arguments arguments(count, words, {"sphere_noisy", "torus3D", "parking-garage", "M3500", "intel"});
  const auto registry = builtinRegistry();
  bench::JsonRows json;
  fmt::print("{:<16} {:>9} {:>12} {:>12} {:>12} {:>9} {:>9}\n", "graph", "MB", "1 thread ms", "2 threads ms",
             "streams ms", "ratio 1", "ratio 2");
  for (const std::string& file : arguments.graphs) {
    const auto read = [&](int threads) {
      return bench::secondsOf([&] {
        if (readGraph(file, registry, {.threads = threads}).edgeCount() == 0) std::abort();
      });
    };
    const auto stream = [&] {
      return bench::secondsOf([&] {
        if (bench::readWithStreams(file).edges.empty()) std::abort();
      });
    };
    const bench::Pair one = bench::comparePairs(
        arguments.rounds, [&] { return read(1); }, stream);
    const bench::Pair two = bench::comparePairs(
        arguments.rounds, [&] { return read(2); }, stream);
    const std::string name = std::filesystem::path(file).stem().string();
    const double megabytes = static_cast<double>(std::filesystem::file_size(file)) / 1e6;
    fmt::print("{:<16} {:>9.2f} {:>12.3f} {:>12.3f} {:>12.3f} {:>8.1f}x {:>8.1f}x\n", name, megabytes, 1e3 * one.ours,
               1e3 * two.ours, 1e3 * one.theirs, one.ratio, two.ratio);
    json.begin(name);
    json.add("megabytes", megabytes);
    json.add("seconds_1_thread", one.ours);
    json.add("seconds_2_threads", two.ours);
    json.add("streams_seconds", one.theirs);
    json.add("ratio_1_thread", one.ratio);
    json.add("ratio_2_threads", two.ratio);
  }
  json.write(arguments.json);
}
