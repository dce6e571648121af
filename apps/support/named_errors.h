#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver::app {

/// Does work on what a file holds. A GraphError of the work is thrown on with the name before its message.
template <typename Work>
decltype(auto) naming(const std::string& file, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const GraphError& error) {
    throw GraphError(fmt::format("{}: {}", file, error.what()));
  }
}

}  // namespace quiver::app
