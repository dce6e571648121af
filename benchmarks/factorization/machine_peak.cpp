#include "factorization/machine_peak.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

namespace quiver::bench {
namespace {

constexpr int rounds = 2'000'000;

constexpr int chains = 10;

/// Independent chains of multiply-adds, enough to hide their latency. Returns a value that depends on all of them.
template <typename Lanes>
inline __attribute__((always_inline)) double chainsOf(double seed) {
  constexpr int width = sizeof(Lanes) / sizeof(double);
  Lanes sums[chains];
  Lanes factor;
  for (int lane = 0; lane < width; ++lane) {
    factor[lane] = 0.999 - 0.001 * lane;
    for (int i = 0; i < chains; ++i) sums[i][lane] = seed + i + lane;
  }
  for (int k = 0; k < rounds; ++k) {
#pragma GCC unroll 10
    for (int i = 0; i < chains; ++i) sums[i] = sums[i] * factor + factor;
  }
  double total = 0.0;
  for (const Lanes& sum : sums) {
    for (int lane = 0; lane < width; ++lane) total += sum[lane];
  }
  return total;
}

struct Loop {
  double (*run)(double seed);
  double flopsPerRound;
};

#if defined(__x86_64__)
typedef double Four __attribute__((vector_size(32)));
typedef double Eight __attribute__((vector_size(64)));
__attribute__((target("avx2,fma"))) double fours(double seed) { return chainsOf<Four>(seed); }
__attribute__((target("avx512f"))) double eights(double seed) { return chainsOf<Eight>(seed); }

/// Which of them is the peak depends on how many vectors of eight a core takes at once, and on its clock with them.
std::vector<Loop> loops() {
  std::vector<Loop> all{{fours, chains * 4.0 * 2.0}};
  if (__builtin_cpu_supports("avx512f")) all.push_back({eights, chains * 8.0 * 2.0});
  return all;
}
#else
typedef double Two __attribute__((vector_size(16)));
std::vector<Loop> loops() { return {{chainsOf<Two>, chains * 2.0 * 2.0}}; }
#endif

double rateOf(const Loop& loop, int threads) {
  std::vector<double> results(static_cast<std::size_t>(threads));
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::thread> others;
  for (int t = 1; t < threads; ++t)
    others.emplace_back([&results, &loop, t] { results[static_cast<std::size_t>(t)] = loop.run(t); });
  results[0] = loop.run(0.5);
  for (std::thread& thread : others) thread.join();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  const bool real = std::ranges::all_of(results, [](double value) { return value == value; });
  return real ? loop.flopsPerRound * rounds * threads / elapsed.count() : 0.0;
}

}  // namespace

double fmaPeak(int threads) {
  double best = 0.0;
  for (const Loop& loop : loops()) {
    for (int repetition = 0; repetition < 8; ++repetition) best = std::max(best, rateOf(loop, threads));
  }
  return best;
}

}  // namespace quiver::bench
