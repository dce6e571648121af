#pragma once

#include <optional>

#include <quiver/core/registry/element_types.h>

namespace quiver::detail {

/// Reads TORO's "BR": the bearing β and the range r of a landmark seen from a pose, and their standard deviations σβ
/// and σr, into an edge whose fields are the landmark's place z = r (cos β, sin β) in the pose's frame. The information
/// is that of z to first order: 1/σr² along the line of sight, 1/(r σβ)² across it. Throws ParseError unless r, σβ and
/// σr are positive.
void readBearingRange(const EdgeType& type, FieldReader& reader, Edge& edge);

struct BearingRange {
  double bearing = 0.0;
  double range = 0.0;
  double bearingDeviation = 0.0;
  double rangeDeviation = 0.0;
};

/// The inverse, to rounding; nothing if the place is the pose's, or if the information is not that of a bearing and a
/// range that do not depend on each other.
std::optional<BearingRange> bearingRangeOf(const EdgeType& type, const Edge& edge);

}  // namespace quiver::detail
