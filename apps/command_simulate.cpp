#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/simulate/bundle_command.h>
#include <quiver/apps/simulate/outliers_command.h>
#include <quiver/apps/simulate/sphere.h>
#include <quiver/apps/simulate/world_command.h>
#include <quiver/apps/support/counted.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>

namespace quiver::app {
namespace {

struct Flags {
  SphereSettings sphere;
  std::string output;
  std::string truth;
  std::vector<double> translationNoise{0.01};
  std::vector<double> rotationNoise{0.01};
};

/// One deviation for all axes, or three.
Vector<double, 3> deviations(const std::vector<double>& values, const char* flag) {
  if (values.size() == 1) return Vector<double, 3>::Constant(values[0]);
  if (values.size() == 3) return Vector<double, 3>(values[0], values[1], values[2]);
  throw UsageError(fmt::format("{} takes one number or three (as 0.1;0.1;0.2), not {}", flag, values.size()));
}

void simulateSphere(const Flags& flags) {
  SphereSettings settings = flags.sphere;
  settings.translationNoise = deviations(flags.translationNoise, "--noise-translation");
  settings.rotationNoise = deviations(flags.rotationNoise, "--noise-rotation");
  checkOutputs({flags.output, flags.truth});
  const SimulatedGraph graph = app::simulateSphere(settings, makeRegistry({}));
  checkOutputFormat(flags.output, graph.measured);
  checkOutputFormat(flags.truth, graph.truth);
  saveGraph(flags.output, graph.measured);
  if (!flags.truth.empty()) saveGraph(flags.truth, graph.truth);
  std::FILE* const stream = flags.output == "-" || flags.truth == "-" ? stderr : stdout;
  tell(stream, "a sphere of {} in {} and {}: {}\n", counted(graph.measured.vertexCount(), "pose"),
       counted(settings.laps, "lap"), counted(graph.measured.edgeCount(), "measurement"), flags.output);
}

void addNoiseOption(CLI::App& command, const char* name, std::vector<double>& values, const char* text) {
  addList(command, name, values, text, numberBetween(1e-100, 1e100), ';')->type_name("A[;B;C]")->default_str("0.01");
}

}  // namespace

void addSimulateCommand(CLI::App& parser, int&) {
  CLI::App* command = parser.add_subcommand("simulate", "Make up a graph, with ground truth");
  command->require_subcommand(1);
  CLI::App* sphere = command->add_subcommand("sphere", "A robot climbs a sphere in laps and sees the lap below");
  auto flags = std::make_shared<Flags>();
  sphere->add_option("-o,--output", flags->output, "Graph to write: noisy odometry as its estimates")
      ->required()
      ->type_name("OUT")
      ->check(outputPath());
  sphere->add_option("--truth", flags->truth, "Write the same graph at the true poses here")
      ->type_name("FILE")
      ->check(outputPath());
  sphere->add_option("--seed", flags->sphere.seed, "Seed of the noise")
      ->type_name("N")
      ->transform(wholeNumber<std::uint64_t>(0))
      ->capture_default_str();
  sphere->add_option("--laps", flags->sphere.laps, "Laps from pole to pole")
      ->type_name("N")
      ->transform(wholeNumber(1, 100000))
      ->capture_default_str();
  sphere->add_option("--nodes-per-lap", flags->sphere.nodesPerLap, "Poses of a lap")
      ->type_name("N")
      ->transform(wholeNumber(3, 100000))
      ->capture_default_str();
  sphere->add_option("--radius", flags->sphere.radius, "Radius in metres")
      ->type_name("R")
      ->check(numberBetween(1e-100, 1e100))
      ->capture_default_str();
  addNoiseOption(*sphere, "--noise-translation", flags->translationNoise,
                 "Standard deviation of measured translations in metres, of all body axes or of each");
  addNoiseOption(*sphere, "--noise-rotation", flags->rotationNoise,
                 "Standard deviation of measured rotations in radians, about all body axes or each");
  sphere->footer(
      "Examples:\n"
      "  quiver simulate sphere -o sphere.g2o --truth sphere_truth.g2o\n"
      "  quiver simulate sphere -o small.g2o --laps 10 --nodes-per-lap 20 --seed 7 --noise-rotation '0.01;0.01;0.05'");
  addBundleSimulation(*command);
  addOutliersSimulation(*command);
  addWorldSimulations(*command);
  sphere->callback([flags] { simulateSphere(*flags); });
}

}  // namespace quiver::app
