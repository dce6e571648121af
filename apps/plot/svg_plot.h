#pragma once

#include <string>
#include <vector>

#include <quiver/apps/plot/scene.h>

namespace quiver::app {

/// A self-contained SVG document: the scenes side by side, each to a scale of its own with a bar that tells it; the
/// trajectory as a line, lone poses as squares, landmarks as dots, loop closures coloured by their misfit on one
/// logarithmic scale for all scenes, with a legend. Landmarks far from all others may lie beyond the frame, and very
/// many sightings are left out; the picture says so. Needs scenes that checkExtent() lets pass.
std::string drawSvg(const std::vector<Scene>& scenes);

/// Throws GraphError if the extent of what is drawn is beyond the range of numbers.
void checkExtent(const Scene& scene);

}  // namespace quiver::app
