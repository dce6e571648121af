#include <map>
#include <optional>

#include <CLI/CLI.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>
#include <quiver/types_slam3d/addons/euler_conversion.h>

namespace quiver::app {
namespace {

struct Flags {
  GraphSource source;
  std::string output;
  std::optional<GraphFormat> format;
};

void convert(const Flags& flags) {
  checkOutputs({flags.output});
  LoadedGraph loaded = loadGraph(flags.source);
  for (const std::string& note : readingNotes(flags.source, loaded.report)) tell(stderr, "{}\n", note);
  const GraphFormat format = flags.format.value_or(formatOfPath(flags.output));
  // What other programs read: TORO's spatial poses are few programs' .g2o.
  if (loaded.report.format == "toro" && (format == GraphFormat::g2o || format == GraphFormat::csv))
    loaded.graph = withQuaternions(loaded.graph);
  checkOutputFormat(flags.output, loaded.graph, format);
  saveGraph(flags.output, loaded.graph, flags.source.threads, format);
}

}  // namespace

void addConvertCommand(CLI::App& parser, int&) {
  CLI::App* command = parser.add_subcommand("convert", "Read a graph in any format known and write it in another");
  auto flags = std::make_shared<Flags>();
  addSourceOptions(*command, flags->source);
  command
      ->add_option(
          "OUT", flags->output,
          "Graph to write: TORO where the name ends in .graph or .toro, a table for .csv, .bal, else .g2o; .gz "
          "and .bz2 compress; - is standard output")
      ->required()
      ->type_name("")
      ->check(outputPath());
  static const std::map<std::string, GraphFormat> formats{
      {"g2o", GraphFormat::g2o}, {"toro", GraphFormat::toro}, {"csv", GraphFormat::csv}, {"bal", GraphFormat::bal}};
  command->add_option("--to", flags->format, "Format to write, whatever the name says")
      ->type_name("g2o|toro|csv|bal")
      ->transform(wordOf(formats));
  command->footer(
      "Examples:\n"
      "  quiver convert toro.graph out.g2o\n"
      "  quiver convert city.g2o city.g2o.gz\n"
      "  quiver convert city.g2o.bz2 - --to csv\n"
      "  quiver convert problem-49-7776-pre.txt.bz2 ladybug.g2o\n"
      "  quiver convert broken.g2o mended.g2o --information clamp --unknown skip");
  command->callback([flags] { convert(*flags); });
}

}  // namespace quiver::app
