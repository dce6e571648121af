#include <quiver/core/problem/pack_rows.h>

#include <algorithm>
#include <limits>

#include <quiver/core/util/parallel.h>

namespace quiver::detail {
namespace {

constexpr int lanes = Panel::lanes;
constexpr std::int64_t chunk = 1024;

}  // namespace

void packRows(const BatchView& view, int arity, std::span<const std::int32_t> edges, EdgeRows& rows, int threads) {
  const auto count = static_cast<std::int64_t>(edges.size()) / lanes;
  const std::int64_t* const last = view.records + view.edges * arity;
  if (view.edges > 0 && *std::max_element(view.records, last) > std::numeric_limits<std::uint32_t>::max()) return;
  if (rows.constants.size() != count * view.numbers * lanes)
    rows.constants = AlignedBuffer(count * view.numbers * lanes, false);
  rows.records.resize(static_cast<std::size_t>(count * arity * lanes));
  parallelFor((count + chunk - 1) / chunk, threads, [&](std::int64_t c) {
    for (std::int64_t row = c * chunk; row < std::min(count, (c + 1) * chunk); ++row) {
      double* constants = rows.constants.data() + row * view.numbers * lanes;
      std::uint32_t* records = rows.records.data() + row * arity * lanes;
      for (int lane = 0; lane < lanes; ++lane) {
        const std::int64_t edge = edges[static_cast<std::size_t>(row * lanes + lane)];
        const double* from = view.constants + edge / lanes * view.numbers * lanes + edge % lanes;
        for (int k = 0; k < view.numbers; ++k) constants[k * lanes + lane] = from[k * lanes];
        for (int role = 0; role < arity; ++role)
          records[role * lanes + lane] = static_cast<std::uint32_t>(view.records[role * view.edges + edge]);
      }
    }
  });
}

}  // namespace quiver::detail
