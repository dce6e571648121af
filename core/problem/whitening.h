#pragma once

#include <cstdint>
#include <span>

namespace quiver::detail {

/// What U, with UᵀU = Ω, is for every edge of a batch: the identity, a diagonal, or any upper triangle. Each is a case
/// of the next.
enum class Whitening : std::uint8_t { none, diagonal, triangular };

/// How many numbers of U an edge keeps: nothing, the diagonal, or the upper triangle row by row.
constexpr int whiteningNumbers(Whitening whitening, int rows) {
  if (whitening == Whitening::none) return 0;
  return whitening == Whitening::diagonal ? rows : rows * (rows + 1) / 2;
}

/// The least general whitening of an information matrix, given as its upper triangle row by row.
constexpr Whitening whiteningOf(std::span<const double> triangle, int rows) {
  bool ones = true;
  std::size_t k = 0;
  for (int r = 0; r < rows; ++r, ++k) {
    ones = ones && triangle[k] == 1.0;
    for (int c = r + 1; c < rows; ++c) {
      if (triangle[++k] != 0.0) return Whitening::triangular;
    }
  }
  return ones ? Whitening::none : Whitening::diagonal;
}

/// column ← U column. In place: row r needs rows ≥ r only.
template <int Rows, typename S, typename Column>
inline void whiten(const S* U, Whitening whitening, Column&& column) {
  if (whitening == Whitening::diagonal) {
    for (int r = 0; r < Rows; ++r) column(r) = U[r] * column(r);
  } else if (whitening == Whitening::triangular) {
    for (int r = 0, k = 0; r < Rows; k += Rows - r, ++r) {
      S sum = U[k] * column(r);
      for (int c = r + 1; c < Rows; ++c) sum += U[k + c - r] * column(c);
      column(r) = sum;
    }
  }
}

/// The same for the columns of a Jacobian block.
template <int Rows, Whitening whitening, typename S, typename Block>
inline void whitenBlock(const S* U, Block& J) {
  for (int c = 0; c < Block::ColsAtCompileTime; ++c) whiten<Rows>(U, whitening, J.col(c));
}

}  // namespace quiver::detail
