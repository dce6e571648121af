#include <quiver/core/algorithm/graph_watch.h>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver {

void GraphWatch::require(std::string_view who) const {
  if (unchanged()) return;
  throw GraphError(
      fmt::format("the {} changed the graph that is being optimised; end the solve first, by a stop token or "
                  "Options::maxIterations",
                  who));
}

}  // namespace quiver
