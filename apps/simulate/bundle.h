#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <quiver/apps/simulate/bundle_scene.h>
#include <quiver/core/registry/registry.h>

namespace quiver::app {

struct BundleCounts {
  std::int64_t cameras = 0;
  std::int64_t points = 0;
  std::int64_t observations = 0;
};

/// Writes the simulated problem, cameras as VERTEX_CAMERA:BAL with the ids 0, 1, …, points after them, to `path` with
/// noisy estimates and, unless `truth` is empty, to `truth` with the true ones; the pixels are the same. A name that
/// ends in .bal (.gz, .bz2) asks for that format, any other for .g2o, whose information is 1 / pixelNoise² (1 without
/// noise; BAL has none). Nothing but the cameras is kept in memory. The same bytes for the same settings and any number
/// of threads. Throws FileError and GraphError.
BundleCounts writeBundle(const BundleSettings& settings, const Registry& registry, const std::string& path,
                         const std::string& truth, int threads);

}  // namespace quiver::app
