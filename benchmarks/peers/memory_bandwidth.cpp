#include "memory_bandwidth.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <limits>
#include <thread>
#include <vector>

#include "measure.h"

namespace quiver::bench {
namespace {

/// Eight sums, so that additions do not wait for each other.
double sumOf(const double* values, std::size_t count) {
  double sums[8] = {};
  for (std::size_t i = 0; i + 8 <= count; i += 8) {
    for (std::size_t k = 0; k < 8; ++k) sums[k] += values[i + k];
  }
  double total = 0.0;
  for (const double sum : sums) total += sum;
  return total;
}

}  // namespace

double readBandwidth(int threads) {
  constexpr std::size_t doubles = std::size_t{48} << 20;  // 384 MB
  const std::vector<double> values(doubles, 1.0);
  double best = std::numeric_limits<double>::infinity();
  std::atomic<double> kept{0.0};
  for (int pass = 0; pass < 5; ++pass) {
    const double seconds = secondsOf([&] {
      std::vector<std::thread> team;
      const std::size_t share = doubles / static_cast<std::size_t>(threads);
      for (int t = 0; t < threads; ++t) {
        team.emplace_back([&, t] { kept = sumOf(values.data() + static_cast<std::size_t>(t) * share, share); });
      }
      for (std::thread& thread : team) thread.join();
    });
    best = std::min(best, seconds);
  }
  return kept.load() > 0.0 ? static_cast<double>(doubles * sizeof(double)) / best : 0.0;
}

}  // namespace quiver::bench
