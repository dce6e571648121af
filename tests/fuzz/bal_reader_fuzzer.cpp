// Any text read as a file of "bundle adjustment in the large": either it is refused with a ParseError, or what is
// written from it reads back to the same bytes, and so does its conversion to .g2o. However many threads read it.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <quiver/core/io/bal/bal_reader.h>
#include <quiver/core/io/bal/bal_writer.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>

namespace {

using namespace quiver;

std::string balText(const Graph& graph) {
  std::string result;
  const auto append = [&](std::string_view text) { result += text; };
  detail::writeBal(graph, 1, append);
  return result;
}

Graph load(const std::string& text, int threads) {
  static const std::shared_ptr<const Registry> registry = builtinRegistry();
  const std::string name = "input";
  return detail::loadBal({text, name}, registry, {.threads = threads});
}

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  std::string once, g2o;
  try {
    const Graph graph = load(text, 1);
    once = balText(graph);
    g2o = graphText(graph, {.threads = 1});
  } catch (const ParseError&) {
    return 0;
  }
  const Graph again = load(once, 2);
  require(balText(again) == once);
  require(graphText(again, {.threads = 1}) == g2o);
  require(balText(readGraphText(g2o, "written", again.registry(), {.threads = 1})) == once);
  return 0;
}
