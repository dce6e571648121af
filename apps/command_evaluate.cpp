#include <map>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/evaluate/trajectory_svg.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>
#include <quiver/core/io/files/input_file.h>
#include <quiver/evaluation/trajectory_error.h>
#include <quiver/version.h>

namespace quiver::app {
namespace {

using Json = nlohmann::ordered_json;

struct Flags {
  std::string estimate;
  std::string truth;
  std::vector<std::string> plugins;
  std::string align = "auto";
  PoseMatching matching = PoseMatching::automatic;
  double stampTolerance = 0.01;
  double step = 1.0;
  double metres = 0.0;
  std::string svg;
  std::string json;
};

/// A graph's poses, or a trajectory file's.
Trajectory load(const std::string& path, const std::shared_ptr<const Registry>& registry) {
  const InputFile file(path);
  if (isTrajectoryText(file.text())) return readTrajectoryText(file.text(), file.name());
  return trajectoryOf(readGraphText(file.text(), file.name(), registry));
}

EvaluationOptions optionsOf(const Flags& flags, const Trajectory& estimate, const Trajectory& truth) {
  const std::map<std::string, AlignmentGroup> groups{{"none", AlignmentGroup::none},
                                                     {"se2", AlignmentGroup::se2},
                                                     {"se3", AlignmentGroup::se3},
                                                     {"sim3", AlignmentGroup::sim3}};
  EvaluationOptions options;
  options.alignment = flags.align != "auto"             ? groups.at(flags.align)
                      : estimate.planar && truth.planar ? AlignmentGroup::se2
                                                        : AlignmentGroup::se3;
  options.matching = flags.matching;
  options.stampTolerance = flags.stampTolerance;
  options.stepInMetres = flags.metres > 0.0;
  options.step = options.stepInMetres ? flags.metres : flags.step;
  return options;
}

Json describe(const ErrorStatistics& s) {
  return {{"count", s.count},   {"rmse", s.rootMeanSquare}, {"mean", s.mean},  {"median", s.median},
          {"std", s.deviation}, {"min", s.least},           {"max", s.largest}};
}

Json describe(const Flags& flags, const EvaluationOptions& options, const TrajectoryError& error) {
  const SO3<double> rotation = SO3<double>::fromMatrix(error.alignment.rotation);
  const Vector<double, 3>& t = error.alignment.translation;
  Json json{{"quiver", QUIVER_VERSION}, {"estimate", displayName(flags.estimate)}, {"truth", displayName(flags.truth)}};
  json["matched_poses"] = error.matched;
  json["alignment"] = {{"group", nameOf(options.alignment)},
                       {"scale", error.alignment.scale},
                       {"rotation_qx_qy_qz_qw", {rotation.x(), rotation.y(), rotation.z(), rotation.w()}},
                       {"translation", {t[0], t[1], t[2]}},
                       {"unique", error.alignment.unique}};
  json["step"] = {{"length", options.step}, {"unit", options.stepInMetres ? "m" : "poses"}};
  json["absolute"] = {{"translation_m", describe(error.absoluteTranslation)},
                      {"rotation_rad", describe(error.absoluteRotation)}};
  json["relative"] = {{"translation_m", describe(error.relativeTranslation)},
                      {"rotation_rad", describe(error.relativeRotation)}};
  return json;
}

void printRow(const char* name, const ErrorStatistics& s) {
  tell(stdout, "{:<24}{:>9}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}\n", name, s.count, s.rootMeanSquare,
       s.mean, s.median, s.deviation, s.least, s.largest);
}

void print(const EvaluationOptions& options, const TrajectoryError& error) {
  tell(stdout, "{} matched poses, alignment {}", error.matched, nameOf(options.alignment));
  if (options.alignment == AlignmentGroup::sim3) tell(stdout, ", scale {:.9g}", error.alignment.scale);
  tell(stdout, ", relative errors over {:g} {}\n", options.step, options.stepInMetres ? "m" : "poses");
  tell(stdout, "{:<24}{:>9}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", "count", "rmse", "mean", "median", "std", "min",
       "max");
  printRow("absolute translation m", error.absoluteTranslation);
  printRow("absolute rotation rad", error.absoluteRotation);
  printRow("relative translation m", error.relativeTranslation);
  printRow("relative rotation rad", error.relativeRotation);
}

void evaluate(const Flags& flags) {
  if (flags.estimate == "-" && flags.truth == "-") throw UsageError("only one trajectory can come from standard input");
  checkOutputs({flags.svg, flags.json});
  const std::shared_ptr<const Registry> registry = makeRegistry(flags.plugins);
  const Trajectory estimate = load(flags.estimate, registry);
  const Trajectory truth = load(flags.truth, registry);
  const EvaluationOptions options = optionsOf(flags, estimate, truth);
  const TrajectoryError error = evaluateTrajectory(estimate, truth, options);
  if (!error.alignment.unique)
    tell(stderr, "the matched positions leave the alignment's rotation open: rotation errors mean nothing\n");
  if (!flags.svg.empty()) saveText(flags.svg, drawTrajectories(error, options.alignment));
  if (!flags.json.empty()) saveJson(flags.json, describe(flags, options, error));
  if (flags.json != "-" && flags.svg != "-") print(options, error);
}

}  // namespace

void addEvaluateCommand(CLI::App& parser, int&) {
  CLI::App* command = parser.add_subcommand("evaluate", "Compare a trajectory with the true one, after alignment");
  auto flags = std::make_shared<Flags>();
  command->add_option("EST", flags->estimate, "Estimate: a graph, or a TUM or KITTI trajectory; - is standard input")
      ->required();
  command->add_option("TRUTH", flags->truth, "Truth, in any of the same formats")->required();
  addPluginOption(*command, flags->plugins);
  command->add_option("--align", flags->align, "Motions to align with: auto is se2 for two planar graphs, else se3")
      ->type_name("GROUP")
      ->check(CLI::IsMember({"auto", "none", "se2", "se3", "sim3"}))
      ->capture_default_str();
  const std::map<std::string, PoseMatching> matchings{{"auto", PoseMatching::automatic},
                                                      {"id", PoseMatching::id},
                                                      {"stamp", PoseMatching::stamp},
                                                      {"order", PoseMatching::order}};
  command->add_option("--match", flags->matching, "Poses that belong together: auto, id, stamp or order")
      ->type_name("BY")
      ->transform(wordOf(matchings))
      ->default_str("auto");
  command->add_option("--max-difference", flags->stampTolerance, "Largest difference of matched time stamps [s]")
      ->type_name("S")
      ->check(numberFrom(0))
      ->capture_default_str();
  CLI::Option* step = command->add_option("--step", flags->step, "Relative errors: poses apart")
                          ->type_name("N")
                          ->check(CLI::Range(1, 1000000000).description(""))
                          ->default_str("1");
  command->add_option("--step-metres", flags->metres, "Relative errors: metres apart, along the truth")
      ->type_name("M")
      ->check(numberFrom(0, false))
      ->excludes(step);
  command->add_option("-o,--output", flags->svg, "Draw both trajectories as SVG here")
      ->type_name("SVG")
      ->check(outputPath());
  command->add_option("--json", flags->json, "Write the errors as JSON here (- is standard output)")
      ->type_name("FILE")
      ->check(outputPath());
  command->footer(
      "Examples:\n  quiver evaluate optimised.g2o truth.g2o -o errors.svg\n"
      "  quiver evaluate monocular.txt truth.txt --align sim3 --step-metres 10 --json -");
  command->callback([flags] { evaluate(*flags); });
}

}  // namespace quiver::app
