#pragma once

#include <quiver/core/registry/element_types.h>

namespace quiver::detail {

/// Reads TORO's "BR": the bearing β and the range r of a landmark seen from a pose, and their standard deviations σβ
/// and σr, into an edge whose fields are the landmark's place z = r (cos β, sin β) in the pose's frame. The information
/// is that of z to first order: 1/σr² along the line of sight, 1/(r σβ)² across it. Throws ParseError unless r, σβ and
/// σr are positive.
void readBearingRange(const EdgeType& type, FieldReader& reader, Edge& edge);

}  // namespace quiver::detail
