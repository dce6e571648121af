#include <quiver/core/problem/dynamic_calls.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <quiver/core/util/error.h>

namespace quiver::detail {

void requireError(const Edge& edge, std::string_view type, int dimension) {
  if (dimension > 0) return;
  throw GraphError(fmt::format(
      "edge {} {} has an information matrix of 0 × 0; an error has at least one number, and the matrix its size", type,
      fmt::join(edge.vertexIds(), " ")));
}

void requireErrorSize(const Edge& edge, std::string_view type, Eigen::Index found, int expected) {
  if (found == expected) return;
  throw GraphError(fmt::format(
      "edge {} {}: computeError returned {} numbers, but the information matrix is {} × {}; they must agree", type,
      fmt::join(edge.vertexIds(), " "), found, expected, expected));
}

void requireEstimateSize(std::string_view type, Eigen::Index found, int expected) {
  if (found == expected) return;
  throw GraphError(
      fmt::format("vertex type {}: oplus returned an estimate of {} numbers for one of {}", type, found, expected));
}

void requireBlockSize(const Edge& edge, std::string_view type, Eigen::Index rows, Eigen::Index columns,
                      int expectedRows, int expectedColumns) {
  if (rows == expectedRows && columns == expectedColumns) return;
  throw GraphError(fmt::format("edge {} {}: linearizeOplus made a block of {} × {} that must be {} × {}", type,
                               fmt::join(edge.vertexIds(), " "), rows, columns, expectedRows, expectedColumns));
}

}  // namespace quiver::detail
