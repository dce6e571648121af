#include <quiver/solvers/cholesky/factor_plan.h>

#include <span>

#include <gtest/gtest.h>
#include <tests/solvers/large_system.h>

namespace quiver::test {
namespace {

using detail::FactorPlan;

/// Columns of a group are factored before any of them is eliminated: none may be in the way of another.
TEST(FactorPlan, columnsOfAGroupDoNotWaitForEachOther) {
  std::mt19937 random(21);
  int grouped = 0;
  for (const std::vector<int>& dimensions : {std::vector<int>{1}, {2}, {3}, {6}}) {
    const FactorPlan plan(largeSystem(dimensions, random).pattern(), 1);
    const int place = detail::leafPlace(plan.leafDimension);
    for (int node = 0; node < static_cast<int>(plan.nodes.size()); ++node) {
      if (!plan.nodes[static_cast<std::size_t>(node)].leaf) continue;
      const detail::LeafView leaf = plan.leafOf(node);
      for (int first = 0; first < leaf.count; first += leaf.columns[first].group) {
        const int end = first + leaf.columns[first].group;
        ASSERT_GT(end, first);
        ASSERT_LE(end, leaf.count);
        if (end > first + 1) ++grouped;
        for (int j = first; j < end; ++j) {
          const detail::LeafColumn& column = leaf.columns[j];
          EXPECT_TRUE(j == first || column.group == 0);
          for (int i = 0; i < column.inside; ++i) EXPECT_GE(leaf.rows[column.rows + i], end * place);
        }
      }
    }
  }
  EXPECT_GT(grouped, 100);
}

/// A panel has every row of its columns outside the subtree, in runs that share no multiple of 8 of the update matrix.
TEST(FactorPlan, panelsHaveTheRowsOfTheirColumns) {
  std::mt19937 random(23);
  int several = 0;
  for (const int b : {4, 5, 6, 7, 8, 9}) {
    const FactorPlan plan(largeSystem({b}, random).pattern(), 1);
    for (int node = 0; node < static_cast<int>(plan.nodes.size()); ++node) {
      const auto& storage = plan.storage[static_cast<std::size_t>(node)];
      EXPECT_EQ(storage.updateLayout.width % 8, 0);
      if (!plan.nodes[static_cast<std::size_t>(node)].leaf) continue;
      EXPECT_EQ(storage.updateLayout.width % b, 0);
      const detail::LeafView leaf = plan.leafOf(node);
      std::vector<int> panelOf(static_cast<std::size_t>(leaf.count), 0);
      const detail::LeafPanel* panel = leaf.panels;
      for (; panel->last < leaf.count; ++panel) {
        const std::span<const detail::RowRun> runs(leaf.panelRuns + panel->runs,
                                                   static_cast<std::size_t>(panel->runCount));
        if (runs.size() > 1) ++several;
        EXPECT_LE(std::int64_t{panel->stride} * (panel->last - panel->first + 1) * b, storage.panelCount);
        std::vector<char> covered(static_cast<std::size_t>(storage.updateLayout.rows), 0);
        int source = 0;
        int end = 0;
        for (const detail::RowRun& run : runs) {
          EXPECT_EQ(run.source, source);
          EXPECT_GE(run.destination / 8 * 8, end);
          end = (run.destination + run.length + 7) / 8 * 8;
          source += end - run.destination / 8 * 8;
          std::fill_n(covered.begin() + run.destination, run.length, char{1});
        }
        EXPECT_EQ(panel->stride, source);
        for (int j = panel->first; j <= panel->last; ++j) {
          const detail::LeafColumn& column = leaf.columns[j];
          EXPECT_EQ(column.below - column.inside, leaf.columns[panel->first].below - leaf.columns[panel->first].inside);
          for (int i = column.inside; i < column.below; ++i) {
            for (int c = 0; c < b; ++c)
              EXPECT_EQ(covered[static_cast<std::size_t>(leaf.positions[column.rows + i] + c)], 1);
          }
          panelOf[static_cast<std::size_t>(j)] = 1;
        }
      }
      for (int j = 0; j < leaf.count; ++j) EXPECT_EQ(leaf.columns[j].inPanel, panelOf[static_cast<std::size_t>(j)]);
    }
  }
  EXPECT_GT(several, 20);
}

}  // namespace
}  // namespace quiver::test
