#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/output.h>

namespace quiver::app {
namespace {

struct Flags {
  GraphSource source;
  std::string output;
};

void convert(const Flags& flags) {
  checkOutputs({flags.output});
  const LoadedGraph loaded = loadGraph(flags.source);
  for (const std::string& note : readingNotes(flags.source, loaded.report)) fmt::print(stderr, "{}\n", note);
  checkOutputFormat(flags.output, loaded.graph);
  saveGraph(flags.output, loaded.graph, flags.source.threads);
}

}  // namespace

void addConvertCommand(CLI::App& parser, int&) {
  CLI::App* command = parser.add_subcommand("convert", "Read a graph in any format known and write it as .g2o or .bal");
  auto flags = std::make_shared<Flags>();
  addSourceOptions(*command, flags->source);
  command
      ->add_option("OUT", flags->output,
                   "Graph to write (.g2o, or .bal where it can; .gz and .bz2 compress; - is standard output)")
      ->required()
      ->type_name("");
  command->footer(
      "Examples:\n"
      "  quiver convert toro.graph out.g2o\n"
      "  quiver convert city.g2o city.g2o.gz\n"
      "  quiver convert problem-49-7776-pre.txt.bz2 ladybug.g2o\n"
      "  quiver convert broken.g2o mended.g2o --information clamp --unknown skip");
  command->callback([flags] { convert(*flags); });
}

}  // namespace quiver::app
