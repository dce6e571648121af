#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/plot/svg_plot.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/output.h>

namespace quiver::app {
namespace {

struct Flags {
  GraphSource source;
  std::string before;
  std::string output;
};

Scene loadScene(GraphSource source, const std::string& path, const char* label) {
  source.path = path;
  const LoadedGraph loaded = loadGraph(source);
  for (const std::string& note : readingNotes(source, loaded.report)) fmt::print(stderr, "{}\n", note);
  return makeScene(loaded.graph, fmt::format("{}{}", label, displayName(path)));
}

void plot(const Flags& flags) {
  checkOutputs({flags.output});
  std::vector<Scene> scenes;
  if (!flags.before.empty()) scenes.push_back(loadScene(flags.source, flags.before, "before: "));
  scenes.push_back(loadScene(flags.source, flags.source.path, flags.before.empty() ? "" : "after: "));
  saveText(flags.output, drawSvg(scenes));
}

}  // namespace

void addPlotCommand(CLI::App& parser, int&) {
  CLI::App* command = parser.add_subcommand("plot", "Draw a graph's trajectory and loop closures as SVG");
  auto flags = std::make_shared<Flags>();
  addSourceOptions(*command, flags->source);
  command->add_option("-o,--output", flags->output, "Picture to write (- is standard output)")
      ->required()
      ->type_name("OUT.svg");
  command->add_option("--before", flags->before, "Draw this graph beside it: the one before the optimisation")
      ->type_name("FILE");
  command->footer(
      "Examples:\n  quiver plot optimised.g2o -o map.svg\n  quiver plot out.g2o --before in.g2o -o both.svg");
  command->callback([flags] { plot(*flags); });
}

}  // namespace quiver::app
