#pragma once

#include <memory>

#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/text/source_text.h>

namespace quiver::detail {

/// The graph of a "bundle adjustment in the large" text: a VERTEX_CAMERA:BAL for each camera, with the ids 0, 1, …, a
/// VERTEX_TRACKXYZ for each point, with the ids after them, and an EDGE_PROJECT_BAL with information I for each
/// observation, in the order of the file. Cameras and points that nothing observes are vertices without edges. Throws
/// ParseError.
Graph loadBal(const SourceText& source, std::shared_ptr<const Registry> registry, const ReadOptions& options);

}  // namespace quiver::detail
