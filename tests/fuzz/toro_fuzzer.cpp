// Any text read as a graph: if TORO's format can hold it, what is written so reads back to as many elements, and to the
// same bytes where nothing is rounded; as a table it reads back to the same .g2o.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>

namespace {

using namespace quiver;

Graph load(const std::string& text) {
  static const std::shared_ptr<const Registry> registry = builtinRegistry();
  return readGraphText(text, "input", registry,
                       {.unknown = UnknownTags::keep, .information = InformationPolicy::clamp, .threads = 1});
}

std::string save(const Graph& graph, GraphFormat format) { return graphText(graph, {.threads = 1, .format = format}); }

void require(bool condition, const std::string& text) {
  if (condition) return;
  std::fputs(text.c_str(), stderr);
  std::abort();
}

void writeAsToro(const Graph& graph) {
  std::string once;
  try {
    once = save(graph, GraphFormat::toro);
  } catch (const GraphError&) {
    return;  // other types
  }
  // Bearings and ranges are computed anew: their deviations may leave the range of doubles.
  const bool rounded = once.find("\nBR ") != std::string::npos || once.starts_with("BR ");
  try {
    const Graph again = load(once);
    require(again.vertexCount() == graph.vertexCount() && again.edgeCount() == graph.edgeCount(), once);
    require(rounded || save(again, GraphFormat::toro) == once, once);
  } catch (const ParseError&) {
    require(rounded, once);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const Graph graph = load(text);
    writeAsToro(graph);
    const std::string table = save(graph, GraphFormat::csv);
    require(save(load(table), GraphFormat::g2o) == save(graph, GraphFormat::g2o), table);
  } catch (const ParseError&) {
    return 0;
  }
  return 0;
}
