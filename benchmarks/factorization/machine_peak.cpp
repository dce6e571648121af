#include "factorization/machine_peak.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

namespace quiver::bench {
namespace {

constexpr int rounds = 2'000'000;

#if defined(__x86_64__)
/// Ten independent chains of 4-wide multiply-adds: enough to hide their latency. Returns a value that depends on all of
/// them.
__attribute__((target("avx2,fma"))) double multiplyAdd(double seed) {
  typedef double Lanes __attribute__((vector_size(32)));
  Lanes sums[10];
  for (int i = 0; i < 10; ++i) sums[i] = Lanes{seed, seed + i, 1.0, 2.0};
  const Lanes factor = Lanes{0.999, 0.998, 0.997, 0.996};
  for (int k = 0; k < rounds; ++k) {
#  pragma GCC unroll 10
    for (int i = 0; i < 10; ++i) sums[i] = sums[i] * factor + factor;
  }
  Lanes total{};
  for (const Lanes& sum : sums) total += sum;
  return total[0] + total[1] + total[2] + total[3];
}
constexpr double flopsPerRound = 10.0 * 4.0 * 2.0;
#else
double multiplyAdd(double seed) {
  double sums[10];
  for (int i = 0; i < 10; ++i) sums[i] = seed + i;
  for (int k = 0; k < rounds; ++k) {
    for (double& sum : sums) sum = sum * 0.999 + 0.998;
  }
  double total = 0.0;
  for (const double sum : sums) total += sum;
  return total;
}
constexpr double flopsPerRound = 10.0 * 2.0;
#endif

}  // namespace

double fmaPeak(int threads) {
  double best = 0.0;
  for (int repetition = 0; repetition < 8; ++repetition) {
    std::vector<double> results(static_cast<std::size_t>(threads));
    const auto begin = std::chrono::steady_clock::now();
    std::vector<std::thread> others;
    for (int t = 1; t < threads; ++t)
      others.emplace_back([&results, t] { results[static_cast<std::size_t>(t)] = multiplyAdd(t); });
    results[0] = multiplyAdd(0.5);
    for (std::thread& thread : others) thread.join();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    const bool real = std::ranges::all_of(results, [](double value) { return value == value; });
    if (real) best = std::max(best, flopsPerRound * rounds * threads / elapsed.count());
  }
  return best;
}

}  // namespace quiver::bench
