#include <quiver/core/problem/panel_totals.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace quiver {
namespace {

std::vector<double> randomNumbers(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<double> numbers(count);
  for (double& number : numbers) number = uniform(random);
  return numbers;
}

CostTotals totalsOf(const std::vector<double>& squares, const std::vector<double>& costs, int step) {
  PanelTotals totals(3);
  const int count = static_cast<int>(squares.size());
  for (int first = 0; first < count; first += step)
    totals.add(100 + first, std::min(step, count - first), squares.data() + first, costs.data() + first);
  return totals.sum();
}

TEST(PanelTotals, AreTheSumWhateverThePanels) {
  for (const std::size_t count : {1UL, 7UL, 8UL, 9UL, 64UL, 65UL, 1003UL}) {
    const std::vector<double> squares = randomNumbers(count, 1), costs = randomNumbers(count, 2);
    long double chi2 = 0.0L, cost = 0.0L;
    for (std::size_t i = 0; i < count; ++i) {
      chi2 += squares[i];
      cost += costs[i];
    }
    const CostTotals totals = totalsOf(squares, costs, 64);
    EXPECT_NEAR(totals.chi2, static_cast<double>(chi2), 1e-14 * static_cast<double>(count));
    EXPECT_NEAR(totals.cost, static_cast<double>(cost), 1e-14 * static_cast<double>(count));
    EXPECT_TRUE(totals.finite());
    for (const int step : {8, 16, 256}) {
      EXPECT_EQ(totalsOf(squares, costs, step).chi2, totals.chi2);
      EXPECT_EQ(totalsOf(squares, costs, step).cost, totals.cost);
    }
  }
}

TEST(PanelTotals, NameTheFirstThatIsNotFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const std::size_t place : {0UL, 5UL, 64UL, 70UL, 98UL}) {
      std::vector<double> squares = randomNumbers(100, 1);
      squares[place] = bad;
      squares[99] = bad;
      const CostTotals totals = totalsOf(squares, squares, 64);
      EXPECT_FALSE(totals.finite());
      EXPECT_EQ(totals.badBatch, 3);
      EXPECT_EQ(totals.badEdge, 100 + static_cast<int>(place));
    }
  }
}

TEST(PanelTotals, AreAddedInOrder) {
  CostTotals all{1.0, 2.0, -1, -1};
  all.add({3.0, 4.0, 5, 6});
  all.add({3.0, 4.0, 7, 8});
  EXPECT_EQ(all.chi2, 7.0);
  EXPECT_EQ(all.cost, 10.0);
  EXPECT_EQ(all.badBatch, 5);
  EXPECT_EQ(all.badEdge, 6);
}

}  // namespace
}  // namespace quiver
