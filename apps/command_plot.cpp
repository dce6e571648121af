#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/plot/structure.h>
#include <quiver/apps/plot/svg_plot.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/named_errors.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>

namespace quiver::app {
namespace {

struct Flags {
  GraphSource source;
  std::string before;
  std::string output;
  bool structure = false;
};

LoadedGraph load(const GraphSource& source) {
  LoadedGraph loaded = loadGraph(source);
  for (const std::string& note : readingNotes(source, loaded.report)) tell(stderr, "{}\n", note);
  return loaded;
}

Scene loadScene(GraphSource source, const std::string& path, const char* label) {
  source.path = path;
  const LoadedGraph loaded = load(source);
  Scene scene = naming(displayName(path), [&loaded] {
    Scene made = makeScene(loaded.graph);
    checkExtent(made);
    return made;
  });
  scene.title = fmt::format("{}{}", label, displayName(path));
  return scene;
}

void plotStructure(const Flags& flags) {
  LoadedGraph loaded = load(flags.source);
  const StructurePictures pictures =
      naming(displayName(flags.source.path), [&loaded] { return pictureStructure(loaded.graph, Options()); });
  saveText(flags.output, drawStructure(pictures));
  std::FILE* const stream = flags.output == "-" ? stderr : stdout;
  for (const MatrixPicture& matrix : pictures.matrices) {
    tell(stream, "{}: {} blocks, {} unknowns a side; {} blocks stored, {} numbers, {:.3g} % full\n", matrix.title,
         matrix.blocks, matrix.scalars, matrix.storedBlocks, matrix.storedScalars, 100.0 * matrix.fill);
  }
}

void plot(const Flags& flags) {
  if (flags.source.path == "-" && flags.before == "-") throw UsageError("only one graph can come from standard input");
  checkOutputs({flags.output});
  checkInputsSpared({flags.output}, {flags.source.path, flags.before});
  if (flags.structure) return plotStructure(flags);
  std::vector<Scene> scenes;
  if (!flags.before.empty()) scenes.push_back(loadScene(flags.source, flags.before, "before: "));
  scenes.push_back(loadScene(flags.source, flags.source.path, flags.before.empty() ? "" : "after: "));
  saveText(flags.output, drawSvg(scenes));
}

}  // namespace

void addPlotCommand(CLI::App& parser, int&) {
  CLI::App* command =
      parser.add_subcommand("plot", "Draw a graph's poses, landmarks and loop closures, or its matrices, as SVG");
  auto flags = std::make_shared<Flags>();
  addSourceOptions(*command, flags->source);
  command->add_option("-o,--output", flags->output, "Picture to write (- is standard output)")
      ->required()
      ->type_name("OUT.svg")
      ->check(outputPath());
  command->add_option("--before", flags->before, "Draw this graph beside it: the one before the optimisation")
      ->type_name("FILE")
      ->check(inputPath());
  command
      ->add_flag(
          "--structure", flags->structure,
          "Draw where H, the reduced matrix and the factor have entries, with the figures of their fill; needs no "
          "estimates")
      ->excludes("--before");
  command->footer(
      "Examples:\n"
      "  quiver plot optimised.g2o -o map.svg\n"
      "  quiver plot out.g2o --before in.g2o -o both.svg\n"
      "  quiver plot ladybug.bal --structure -o arrow.svg");
  command->callback([flags] { plot(*flags); });
}

}  // namespace quiver::app
