#include <quiver/apps/support/long_work.h>

#include <filesystem>

#include <fmt/format.h>

#include <quiver/apps/support/standard_streams.h>

namespace quiver::app {

void LongWork::reading(const std::string& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  long_ = !error && bytes > longBytes;
  tell(fmt::format("reading {} ({} MB)", path, error ? 0 : bytes / 1000000));
}

void LongWork::expect(const Graph& graph) { long_ = long_ || graph.vertexCount() + graph.edgeCount() > longElements; }

void LongWork::tell(std::string_view phase) const {
  if (long_ && !quiet_) app::tell(stderr, "[{:7.1f} s] {}\n", clock_.seconds(), phase);
}

}  // namespace quiver::app
