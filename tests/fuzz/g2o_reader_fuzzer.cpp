// Any text read as a graph: either it is refused with a ParseError, or what is written from it reads back to the same
// bytes.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>

namespace {

using namespace quiver;

const std::shared_ptr<const Registry>& registry() {
  static const std::shared_ptr<const Registry> builtin = builtinRegistry();
  return builtin;
}

void readAndWrite(const std::string& text) {
  const ReadOptions options{.unknown = UnknownTags::keep, .information = InformationPolicy::clamp, .threads = 1};
  std::string once;
  try {
    once = graphText(readGraphText(text, "input", registry(), options), {.threads = 1});
  } catch (const ParseError&) {
    return;
  }
  // Information is checked this time: what was clamped must pass.
  const Graph again = readGraphText(once, "written", registry(), {.unknown = UnknownTags::keep, .threads = 1});
  if (graphText(again, {.threads = 1}) != once) {
    std::fputs(once.c_str(), stderr);
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  readAndWrite(text);
  try {
    readGraphText(text, "input", registry(), {.unknown = UnknownTags::error, .threads = 1});
  } catch (const ParseError&) {
  }
  return 0;
}
