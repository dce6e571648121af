#include <quiver/apps/simulate/world_command.h>

#include <map>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <quiver/apps/simulate/world_settings.h>
#include <quiver/apps/support/counted.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>

namespace quiver::app {
namespace {

struct Flags {
  WorldSettings world;
  std::string output;
  std::string truth;
  std::vector<std::string> sensors;
};

/// Sensors by name; odometry is always there.
void applySensors(const std::vector<std::string>& sensors, WorldSettings& world) {
  const std::map<std::string, bool*> switches{{"pose", &world.poseSensor},
                                              {"point", &world.pointSensor},
                                              {"bearing", &world.bearingSensor},
                                              {"depth", &world.depthSensor},
                                              {"disparity", &world.disparitySensor},
                                              {"compass", &world.compass},
                                              {"gps", &world.gps}};
  for (const auto& [name, on] : switches) *on = false;
  for (const std::string& sensor : sensors) {
    if (sensor != "odometry") *switches.at(sensor) = true;
  }
}

void simulate(const Flags& flags) {
  if (flags.output == flags.truth) throw UsageError("the graph and its truth go to the same place");
  checkOutputs({flags.output, flags.truth});
  for (const std::string& path : {flags.output, flags.truth}) checkStreamedFormat(path, {GraphFormat::g2o});
  WorldSettings world = flags.world;
  applySensors(flags.sensors, world);
  WorldCounts counts;
  try {
    counts = simulateWorld(world, flags.output, flags.truth);
  } catch (const GraphError& error) {
    throw UsageError(error.what());
  } catch (const FileError& error) {
    throw OutputError(error.what());
  }
  std::FILE* const stream = flags.output == "-" || flags.truth == "-" ? stderr : stdout;
  tell(stream, "{}, {} and {}: {}\n", counted(counts.poses, "pose"), counted(counts.landmarks, "landmark"),
       counted(counts.edges, "measurement"), flags.output);
}

void addWorld(CLI::App& simulateCommand, WorldKind kind, const char* name, const char* text,
              const std::vector<std::string>& sensors, const std::vector<std::string>& initial) {
  CLI::App* command = simulateCommand.add_subcommand(name, text);
  auto flags = std::make_shared<Flags>();
  flags->world.kind = kind;
  flags->sensors = initial;
  command->add_option("-o,--output", flags->output, "Graph to write: noisy odometry as its estimates")
      ->required()
      ->type_name("OUT")
      ->check(outputPath());
  command->add_option("--truth", flags->truth, "Write the same graph at the true estimates here")
      ->type_name("FILE")
      ->check(outputPath());
  command->add_option("--seed", flags->world.seed, "Seed of the way and the noise")
      ->type_name("N")
      ->transform(wholeNumber<std::uint64_t>(0))
      ->capture_default_str();
  command->add_option("--poses", flags->world.poses, "Number of poses")
      ->type_name("N")
      ->transform(wholeNumber<std::int64_t>(0))
      ->capture_default_str();
  command->add_option("--side", flags->world.side, "Side of the world in metres; 0: from the number of poses")
      ->type_name("M")
      ->check(numberFrom(0))
      ->capture_default_str();
  if (kind == WorldKind::landmarks2d || kind == WorldKind::landmarks3d)
    command->add_option("--landmarks", flags->world.landmarks, "Number of landmarks in the world")
        ->type_name("N")
        ->transform(wholeNumber<std::int64_t>(0))
        ->capture_default_str();
  addList(*command, "--sensors", flags->sensors,
          fmt::format("Any of {}; odometry is always among them", fmt::join(sensors, ", ")), wordAmong(sensors))
      ->type_name("A[,B...]")
      ->default_str(fmt::format("{}", fmt::join(initial, ",")));
  command->footer(
      fmt::format("Example:\n  quiver simulate {0} -o {0}.g2o --truth truth.g2o --poses 10000 --seed 7", name));
  command->callback([flags] { simulate(*flags); });
}

}  // namespace

void addWorldSimulations(CLI::App& simulateCommand) {
  addWorld(simulateCommand, WorldKind::manhattan, "manhattan", "A robot walks the streets of a city at random",
           {"odometry", "pose", "compass", "gps"}, {"odometry", "pose"});
  addWorld(simulateCommand, WorldKind::grid, "grid", "A robot mows a field row by row",
           {"odometry", "pose", "compass", "gps"}, {"odometry", "pose"});
  addWorld(simulateCommand, WorldKind::landmarks2d, "landmarks-2d", "A robot among landmarks in the plane",
           {"odometry", "pose", "point", "bearing", "compass", "gps"}, {"odometry", "point"});
  addWorld(simulateCommand, WorldKind::landmarks3d, "landmarks-3d", "A robot with a camera among landmarks in space",
           {"odometry", "pose", "point", "depth", "disparity", "compass", "gps"}, {"odometry", "point"});
}

}  // namespace quiver::app
