#include <quiver/core/graph/edge_id_list.h>

#include <numeric>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace quiver {
namespace {

using ::testing::ElementsAreArray;
using Ids = std::vector<std::int64_t>;

Ids counted(std::size_t count, std::int64_t from) {
  Ids ids(count);
  std::iota(ids.begin(), ids.end(), from);
  return ids;
}

void expectIds(const EdgeIdList& list, const Ids& vertices, const Ids& parameters) {
  EXPECT_THAT(list.vertices(), ElementsAreArray(vertices));
  EXPECT_THAT(list.parameters(), ElementsAreArray(parameters));
  EXPECT_EQ(list.vertexCount(), static_cast<int>(vertices.size()));
}

TEST(EdgeIdList, KeepsShortAndLongLists) {
  expectIds(EdgeIdList(), {}, {});
  for (const std::size_t vertices : {0u, 1u, 3u, 4u, 5u, 40u}) {
    for (const std::size_t parameters : {0u, 1u, 2u, 7u})
      expectIds(EdgeIdList(counted(vertices, 10), counted(parameters, 100)), counted(vertices, 10),
                counted(parameters, 100));
  }
}

TEST(EdgeIdList, IsAssignedInPlace) {
  EdgeIdList list;
  for (const std::size_t vertices : {2u, 9u, 1u, 4u, 12u, 30u, 0u, 5u}) {
    for (const std::size_t parameters : {1u, 0u, 6u}) {
      list.assign(counted(vertices, 10), counted(parameters, 100));
      expectIds(list, counted(vertices, 10), counted(parameters, 100));
    }
  }
}

TEST(EdgeIdList, CopiesAndMoves) {
  for (const std::size_t first : {2u, 9u}) {
    for (const std::size_t second : {1u, 12u}) {
      const Ids a = counted(first, 1);
      const Ids b = counted(second, 50);
      EdgeIdList one(a, b);
      EdgeIdList two(b, {});
      EdgeIdList copy(one);
      expectIds(copy, a, b);
      copy = two;
      expectIds(copy, b, {});
      copy = std::as_const(copy);
      expectIds(copy, b, {});
      copy = std::move(one);
      expectIds(copy, a, b);
      const EdgeIdList moved(std::move(copy));
      expectIds(moved, a, b);
      expectIds(two, b, {});
    }
  }
}

}  // namespace
}  // namespace quiver
