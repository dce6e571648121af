#pragma once

#include <string>

#include <quiver/evaluation/trajectory_error.h>

namespace quiver::app {

/// A self-contained SVG document: the truth and the aligned estimate seen along the axis in which the truth extends
/// least, and a thin line from each pose to its true place. `group` names the alignment.
std::string drawTrajectories(const TrajectoryError& error, AlignmentGroup group);

}  // namespace quiver::app
