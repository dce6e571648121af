#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <quiver/core/util/parallel.h>

namespace quiver {

/// join(… join(part(0, a), part(a, b)) …, part(y, count)): what `part(begin, end)` returns for consecutive pieces of
/// `count` numbers, on at most `threads` threads. Pieces and their order depend on the count alone, so the result has
/// the same bits for any number of threads.
template <typename Part, typename Join>
auto overPieces(std::size_t count, int threads, const Part& part, const Join& join) {
  constexpr std::size_t most = 8;
  constexpr std::size_t least = 2048;
  const std::size_t pieces = std::clamp<std::size_t>(count / least, 1, most);
  if (pieces == 1) return part(std::size_t{0}, count);
  std::array<decltype(part(count, count)), most> results{};
  parallelFor(static_cast<std::int64_t>(pieces), threads, [&](std::int64_t i) {
    const auto piece = static_cast<std::size_t>(i);
    results[piece] = part(piece * count / pieces, (piece + 1) * count / pieces);
  });
  auto result = results[0];
  for (std::size_t piece = 1; piece < pieces; ++piece) result = join(result, results[piece]);
  return result;
}

}  // namespace quiver
