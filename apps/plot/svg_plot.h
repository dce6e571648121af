#pragma once

#include <string>
#include <vector>

#include <quiver/apps/plot/scene.h>

namespace quiver::app {

/// A self-contained SVG document: the scenes side by side, each to a scale of its own with a bar that tells it; the
/// trajectory as a line, loop closures coloured by their misfit on one logarithmic scale for all scenes, with a legend.
std::string drawSvg(const std::vector<Scene>& scenes);

}  // namespace quiver::app
