#pragma once

#include <cstdint>

#include <quiver/core/problem/panel.h>
#include <quiver/core/problem/whitening.h>
#include <quiver/core/util/stop_condition.h>

namespace quiver::detail {

/// What a batch loop reads: constants of the edges, laid out once when the problem is compiled.
///
/// `constants` holds measurement, parameters and U (UᵀU = Ω) of every edge, `numbers` in all: in lanes, number k of
/// edge i at ((i / 8) * numbers + k) * 8 + i % 8, or one edge after the other at i * numbers + k. Of U as many
/// numbers as the whitening of the batch needs. `records` holds, role by role, where
/// each edge's vertex lies in a state.
struct BatchView {
  const double* constants = nullptr;
  int numbers = 0;
  const std::int64_t* records = nullptr;
  std::int64_t edges = 0;
  const double* state = nullptr;
  Whitening whitening = Whitening::triangular;
  const Edge* const* objects = nullptr;
  /// Not null: edges come in rows of eight, and `constants` begins with the first row. Where the vertices of a row lie
  /// in the state, eight numbers for each role.
  const std::uint32_t* rows = nullptr;
  /// To be asked before every edge, if not null.
  const StopCondition* stop = nullptr;
};

}  // namespace quiver::detail
