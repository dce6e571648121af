#include <quiver/apps/simulate/outliers_command.h>

#include <CLI/CLI.hpp>

#include <quiver/apps/simulate/wrong_loops.h>
#include <quiver/apps/support/counted.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/named_errors.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>

namespace quiver::app {
namespace {

struct Flags {
  GraphSource source;
  std::string output;
  double fraction = 0.1;
  std::uint64_t seed = 0;
};

void simulateOutliers(const Flags& flags) {
  checkOutputs({flags.output});
  LoadedGraph loaded = loadGraph(flags.source);
  for (const std::string& note : readingNotes(flags.source, loaded.report)) tell(stderr, "{}\n", note);
  checkOutputFormat(flags.output, loaded.graph);
  const std::int64_t added =
      naming(displayName(flags.source.path), [&] { return addWrongLoops(loaded.graph, flags.fraction, flags.seed); });
  saveGraph(flags.output, loaded.graph, flags.source.threads);
  tell(flags.output == "-" ? stderr : stdout, "{} added: {}\n", counted(added, "wrong loop closure"), flags.output);
}

}  // namespace

void addOutliersSimulation(CLI::App& simulate) {
  CLI::App* command = simulate.add_subcommand("outliers", "Add wrong loop closures to a pose graph");
  auto flags = std::make_shared<Flags>();
  addSourceOptions(*command, flags->source);
  command->add_option("-o,--output", flags->output, "Graph to write")
      ->required()
      ->type_name("OUT")
      ->check(outputPath());
  command->add_option("--fraction", flags->fraction, "Wrong loop closures, as a part of the number of right ones")
      ->type_name("F")
      ->check(numberFrom(0))
      ->capture_default_str();
  command->add_option("--seed", flags->seed, "Seed of the draw")
      ->type_name("N")
      ->transform(wholeNumber<std::uint64_t>(0))
      ->capture_default_str();
  command->footer(
      "Example:\n"
      "  quiver simulate outliers city.g2o -o wrong.g2o --fraction 0.1 --seed 1\n"
      "  quiver optimize wrong.g2o --init odometry --robust dcs:1 --robust-edges loops -o robust.g2o");
  command->callback([flags] { simulateOutliers(*flags); });
}

}  // namespace quiver::app
