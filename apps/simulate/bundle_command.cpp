#include <quiver/apps/simulate/bundle_command.h>

#include <algorithm>
#include <type_traits>

#include <CLI/CLI.hpp>

#include <quiver/apps/simulate/bundle.h>
#include <quiver/apps/support/counted.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>
#include <quiver/core/util/error.h>

namespace quiver::app {
namespace {

struct Flags {
  BundleSettings bundle;
  std::string output;
  std::string truth;
  int threads = 0;
};

void simulateBundle(const Flags& flags) {
  checkOutputs({flags.output, flags.truth});
  for (const std::string& path : {flags.output, flags.truth})
    checkStreamedFormat(path, {GraphFormat::g2o, GraphFormat::bal});
  BundleCounts counts;
  try {
    check(flags.bundle);
  } catch (const GraphError& error) {
    throw UsageError(error.what());
  }
  try {
    counts = writeBundle(flags.bundle, *makeRegistry({}), flags.output, flags.truth, flags.threads);
  } catch (const FileError& error) {
    throw OutputError(error.what());
  }
  std::FILE* const stream = flags.output == "-" || flags.truth == "-" ? stderr : stdout;
  tell(stream, "a {} of {}, {} and {}, {:.1f} a point: {}\n", flags.bundle.scene, counted(counts.cameras, "camera"),
       counted(counts.points, "point"), counted(counts.observations, "observation"),
       static_cast<double>(counts.observations) / static_cast<double>(std::max<std::int64_t>(counts.points, 1)),
       flags.output);
}

template <typename Number>
void addNumber(CLI::App& command, const char* name, Number& value, const char* text) {
  CLI::Option* option = command.add_option(name, value, text)->type_name("N")->capture_default_str();
  if constexpr (std::is_integral_v<Number>) {
    option->transform(wholeNumber<Number>(0));
  } else {
    option->check(numberFrom(0));
  }
}

}  // namespace

void addBundleSimulation(CLI::App& simulate) {
  CLI::App* command = simulate.add_subcommand("bundle", "Cameras see points: a bundle adjustment problem");
  auto flags = std::make_shared<Flags>();
  BundleSettings& bundle = flags->bundle;
  command->add_option("-o,--output", flags->output, "Problem to write with noisy estimates (.bal or .g2o)")
      ->required()
      ->type_name("OUT")
      ->check(outputPath());
  command->add_option("--truth", flags->truth, "Write the same problem at the true cameras and points here")
      ->type_name("FILE")
      ->check(outputPath());
  command->add_option("--scene", bundle.scene, "loop: a circle, looking outwards; city: round the blocks of a city")
      ->type_name("loop|city")
      ->check(wordAmong({"loop", "city"}))
      ->capture_default_str();
  addNumber(*command, "--cameras", bundle.cameras, "Cameras");
  addNumber(*command, "--points", bundle.points, "Points");
  addNumber(*command, "--track-length", bundle.trackLength,
            "Observations of a point on average, at least 2, as far as so many cameras see it");
  addNumber(*command, "--rounds", bundle.rounds, "Times that the same way is gone");
  addNumber(*command, "--noise", bundle.pixelNoise, "Standard deviation of a pixel");
  addNumber(*command, "--outliers", bundle.outliers, "Share of observations that are anywhere in the image");
  addNumber(*command, "--error-rotation", bundle.rotationError, "Deviation of the cameras' estimates in radians");
  addNumber(*command, "--error-position", bundle.positionError, "Deviation of the cameras' estimates in metres");
  addNumber(*command, "--error-point", bundle.pointError, "Deviation of the points' estimates in metres");
  addNumber(*command, "--seed", bundle.seed, "Seed of everything that is random");
  addThreadsOption(*command, flags->threads);
  command->footer(
      "Examples:\n"
      "  quiver simulate bundle -o loop.bal --truth loop_truth.bal\n"
      "  quiver simulate bundle -o city.g2o --scene city --cameras 2000 --points 250000 --track-length 4 --outliers "
      "0.02");
  command->callback([flags] { simulateBundle(*flags); });
}

}  // namespace quiver::app
