#include <quiver/core/util/pieces.h>

#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace quiver {
namespace {

TEST(OverPieces, visitsEveryNumberOnceInRuns) {
  for (const std::size_t count : {0u, 1u, 7u, 2047u, 4096u, 5000u, 100003u}) {
    for (const int threads : {1, 2, 5}) {
      std::vector<char> seen(count, 0);
      const auto part = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++seen[i];
        return end - begin;
      };
      EXPECT_EQ(overPieces(count, threads, part, std::plus<>()), count);
      EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(count)) << count;
    }
  }
}

TEST(OverPieces, hasTheSameBitsForAnyNumberOfThreads) {
  constexpr std::size_t count = 54321;
  const auto part = [](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += std::sin(static_cast<double>(i)) * std::pow(10.0, i % 17);
    return sum;
  };
  const double alone = overPieces(count, 1, part, std::plus<>());
  for (const int threads : {2, 3, 8}) EXPECT_EQ(overPieces(count, threads, part, std::plus<>()), alone) << threads;
}

/// Parts are joined from the first to the last: what they return need not commute.
TEST(OverPieces, joinsInOrder) {
  const auto part = [](std::size_t begin, std::size_t end) { return std::vector<std::size_t>{begin, end}; };
  const auto join = [](std::vector<std::size_t> a, const std::vector<std::size_t>& b) {
    EXPECT_EQ(a.back(), b.front());
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  const std::vector<std::size_t> borders = overPieces(30000, 3, part, join);
  EXPECT_EQ(borders.front(), 0u);
  EXPECT_EQ(borders.back(), 30000u);
}

}  // namespace
}  // namespace quiver
