#include <quiver/core/io/files/graph_format.h>

namespace quiver {

GraphFormat formatOfPath(std::string_view path) {
  for (const std::string_view compression : {".gz", ".bz2"}) {
    if (path.ends_with(compression)) path.remove_suffix(compression.size());
  }
  if (path.ends_with(".bal")) return GraphFormat::bal;
  if (path.ends_with(".csv")) return GraphFormat::csv;
  if (path.ends_with(".graph") || path.ends_with(".toro")) return GraphFormat::toro;
  return GraphFormat::g2o;
}

}  // namespace quiver
