#pragma once

#include <string_view>

namespace quiver {

/// The formats that graphs are written in. Which one a file holds is told by its text.
enum class GraphFormat {
  g2o,
  /// VERTEX2, EDGE2, BR, VERTEX3, EDGE3.
  toro,
  /// The elements of .g2o as rows of a table, separated by commas.
  csv,
  /// "Bundle adjustment in the large".
  bal,
};

/// What the name of a file asks for: .graph and .toro for TORO, .csv, .bal, anything else for .g2o; .gz and .bz2 may
/// follow.
GraphFormat formatOfPath(std::string_view path);

}  // namespace quiver
