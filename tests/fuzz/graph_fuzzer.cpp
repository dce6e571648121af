// Any text read as a graph with the built-in types: a file's error, or a graph that is written and read again alike.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>

namespace {

using namespace quiver;

void readWriteRead(std::string_view text, const ReadOptions& options) {
  static const auto registry = builtinRegistry();
  std::string written;
  try {
    written = graphText(readGraphText(text, "input", registry, options));
  } catch (const Error&) {
    return;
  }
  // What was written must be readable, and writing it again must change nothing.
  if (graphText(readGraphText(written, "written", registry, options)) != written) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  readWriteRead(text, {.threads = 1});
  readWriteRead(text, {.unknown = UnknownTags::keep, .information = InformationPolicy::clamp, .threads = 1});
  return 0;
}
