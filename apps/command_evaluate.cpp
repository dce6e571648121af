#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/evaluate/trajectory_svg.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/named_errors.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>
#include <quiver/core/io/files/input_file.h>
#include <quiver/evaluation/trajectory_error.h>
#include <quiver/version.h>

namespace quiver::app {
namespace {

using Json = nlohmann::ordered_json;

/// What --align says.
enum class Align { automatic, none, se2, se3, sim3 };

struct Flags {
  /// How graphs are read; its path is unused.
  GraphSource source;
  std::string estimate;
  std::string truth;
  Align align = Align::automatic;
  PoseMatching matching = PoseMatching::automatic;
  std::optional<double> stampTolerance;
  double step = 1.0;
  double metres = 0.0;
  std::string svg;
  std::string json;
};

constexpr const char* extentNotFinite = "the positions' extent, squared, is not finite: errors cannot be computed";

/// Throws GraphError if squares of distances are beyond the range of numbers.
void checkExtent(const Trajectory& trajectory) {
  if (trajectory.poses.empty()) return;
  Vector<double, 3> least = trajectory.poses.front().pose.translation();
  Vector<double, 3> largest = least;
  for (const TrajectoryPose& pose : trajectory.poses) {
    least = least.cwiseMin(pose.pose.translation());
    largest = largest.cwiseMax(pose.pose.translation());
  }
  if (!std::isfinite((largest - least).squaredNorm())) throw GraphError(extentNotFinite);
}

/// The same for what is between two trajectories.
void checkErrors(const TrajectoryError& error) {
  bool finite = std::isfinite(error.alignment.scale) && error.alignment.translation.allFinite();
  for (const ErrorStatistics* s :
       {&error.absoluteTranslation, &error.absoluteRotation, &error.relativeTranslation, &error.relativeRotation})
    finite = finite && std::isfinite(s->rootMeanSquare) && std::isfinite(s->mean) && std::isfinite(s->deviation);
  if (!finite) throw GraphError(extentNotFinite);
}

/// A graph's poses, or a trajectory file's.
Trajectory load(GraphSource source, const std::string& path, const std::shared_ptr<const Registry>& registry) {
  const InputFile file(path);
  if (isTrajectoryText(file.text())) return readTrajectoryText(file.text(), file.name());
  source.path = path;
  ReadReport report;
  const Graph graph = readGraphText(file.text(), file.name(), registry, readOptions(source, report));
  for (const std::string& note : readingNotes(source, report)) tell(stderr, "{}\n", note);
  return naming(displayName(path), [&] { return trajectoryOf(graph); });
}

AlignmentGroup groupOf(Align align, bool planar) {
  switch (align) {
    case Align::none:
      return AlignmentGroup::none;
    case Align::se2:
      return AlignmentGroup::se2;
    case Align::se3:
      return AlignmentGroup::se3;
    case Align::sim3:
      return AlignmentGroup::sim3;
    case Align::automatic:
      break;
  }
  return planar ? AlignmentGroup::se2 : AlignmentGroup::se3;
}

EvaluationOptions optionsOf(const Flags& flags, const Trajectory& estimate, const Trajectory& truth) {
  EvaluationOptions options;
  options.alignment = groupOf(flags.align, estimate.planar && truth.planar);
  options.matching = flags.matching;
  if (flags.stampTolerance) options.stampTolerance = *flags.stampTolerance;
  options.stepInMetres = flags.metres > 0.0;
  options.step = options.stepInMetres ? flags.metres : flags.step;
  return options;
}

/// The statistics of no error are unknown, not zero.
Json describe(const ErrorStatistics& s) {
  if (s.count == 0) {
    return {{"count", 0},     {"rmse", nullptr}, {"mean", nullptr}, {"median", nullptr},
            {"std", nullptr}, {"min", nullptr},  {"max", nullptr}};
  }
  return {{"count", s.count},   {"rmse", s.rootMeanSquare}, {"mean", s.mean},  {"median", s.median},
          {"std", s.deviation}, {"min", s.least},           {"max", s.largest}};
}

Json describe(const Flags& flags, const EvaluationOptions& options, const TrajectoryError& error) {
  const SO3<double> rotation = SO3<double>::fromMatrix(error.alignment.rotation);
  const Vector<double, 3>& t = error.alignment.translation;
  Json json{{"quiver", QUIVER_VERSION}, {"estimate", displayName(flags.estimate)}, {"truth", displayName(flags.truth)}};
  json["matched_poses"] = error.matched;
  json["matched_by"] = nameOf(error.matching);
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

void printRow(std::FILE* stream, const char* name, const ErrorStatistics& s) {
  if (s.count == 0) return tell(stream, "{:<24}{:>9}  of a single pose there is none\n", name, 0);
  tell(stream, "{:<24}{:>9}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}\n", name, s.count, s.rootMeanSquare,
       s.mean, s.median, s.deviation, s.least, s.largest);
}

void print(std::FILE* stream, const EvaluationOptions& options, const TrajectoryError& error) {
  tell(stream, "{} matched {} (by {}), alignment {}", error.matched, error.matched == 1 ? "pose" : "poses",
       nameOf(error.matching), nameOf(options.alignment));
  if (options.alignment == AlignmentGroup::sim3) tell(stream, ", scale {:.9g}", error.alignment.scale);
  const char* const unit = options.stepInMetres ? "m" : options.step == 1.0 ? "pose" : "poses";
  tell(stream, ", relative errors over {:g} {}\n", options.step, unit);
  tell(stream, "{:<24}{:>9}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", "count", "rmse", "mean", "median", "std", "min",
       "max");
  printRow(stream, "absolute translation m", error.absoluteTranslation);
  printRow(stream, "absolute rotation rad", error.absoluteRotation);
  printRow(stream, "relative translation m", error.relativeTranslation);
  printRow(stream, "relative rotation rad", error.relativeRotation);
}

void evaluate(const Flags& flags) {
  if (flags.estimate == "-" && flags.truth == "-") throw UsageError("only one trajectory can come from standard input");
  checkOutputs({flags.svg, flags.json});
  checkInputsSpared({flags.svg, flags.json}, {flags.estimate, flags.truth});
  const std::shared_ptr<const Registry> registry = makeRegistry(flags.source.plugins);
  const Trajectory estimate = load(flags.source, flags.estimate, registry);
  naming(displayName(flags.estimate), [&] { checkExtent(estimate); });
  const Trajectory truth = load(flags.source, flags.truth, registry);
  naming(displayName(flags.truth), [&] { checkExtent(truth); });
  const EvaluationOptions options = optionsOf(flags, estimate, truth);
  const TrajectoryError error =
      naming(fmt::format("{} against {}", displayName(flags.estimate), displayName(flags.truth)), [&] {
        TrajectoryError found = evaluateTrajectory(estimate, truth, options);
        checkErrors(found);
        return found;
      });
  if (flags.stampTolerance && error.matching != PoseMatching::stamp)
    throw UsageError(
        fmt::format("--max-difference is of time stamps, and these poses are matched by {}", nameOf(error.matching)));
  if (!error.alignment.unique)
    tell(stderr, "the matched positions leave the alignment's rotation open: rotation errors mean nothing\n");
  if (!flags.svg.empty()) saveText(flags.svg, drawTrajectories(error, options.alignment));
  if (!flags.json.empty()) saveJson(flags.json, describe(flags, options, error));
  if (flags.json != "-") print(flags.svg == "-" ? stderr : stdout, options, error);
}

}  // namespace

void addEvaluateCommand(CLI::App& parser, int&) {
  CLI::App* command = parser.add_subcommand("evaluate", "Compare a trajectory with the true one, after alignment");
  auto flags = std::make_shared<Flags>();
  command->add_option("EST", flags->estimate, "Estimate: a graph, or a TUM or KITTI trajectory; - is standard input")
      ->required()
      ->type_name("");
  command->add_option("TRUTH", flags->truth, "Truth, in any of the same formats")->required()->type_name("");
  addReadingOptions(*command, flags->source);
  const std::map<std::string, Align> groups{{"auto", Align::automatic},
                                            {"none", Align::none},
                                            {"se2", Align::se2},
                                            {"se3", Align::se3},
                                            {"sim3", Align::sim3}};
  command->add_option("--align", flags->align, "Motions to align with: auto is se2 for two planar graphs, else se3")
      ->type_name("auto|none|se2|se3|sim3")
      ->transform(wordOf(groups))
      ->default_str("auto");
  const std::map<std::string, PoseMatching> matchings{{"auto", PoseMatching::automatic},
                                                      {"id", PoseMatching::id},
                                                      {"stamp", PoseMatching::stamp},
                                                      {"order", PoseMatching::order}};
  command
      ->add_option("--match", flags->matching,
                   "What tells which poses belong together: auto is id for two graphs, "
                   "stamp where both have stamps, else order")
      ->type_name("auto|id|stamp|order")
      ->transform(wordOf(matchings))
      ->default_str("auto");
  command->add_option("--max-difference", flags->stampTolerance, "Largest difference of matched time stamps [s]")
      ->type_name("S")
      ->check(numberFrom(0))
      ->default_str("0.01");
  CLI::Option* step = command->add_option("--step", flags->step, "Relative errors: poses apart")
                          ->type_name("N")
                          ->transform(wholeNumber(1, 1000000000))
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
