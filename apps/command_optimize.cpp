#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/optimize/optimize_report.h>
#include <quiver/apps/optimize/overrides.h>
#include <quiver/apps/optimize/progress.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/initial_guess.h>
#include <quiver/apps/support/interrupt.h>
#include <quiver/apps/support/log_dialect.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/output.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/problem/problem.h>
#include <quiver/core/util/stopwatch.h>

namespace quiver::app {
namespace {

struct Flags {
  GraphSource source;
  Dialect dialect = Dialect::g2o;
  std::string output;
  std::string json;
  std::string algorithm = "auto";
  std::string solver = "auto";
  std::string init = "auto";
  std::string robust;
  GaugePolicy gauge = GaugePolicy::automatic;
  std::vector<std::int64_t> fix;
  std::vector<std::int64_t> only;
  std::vector<std::string> eliminate = {"auto"};
  std::int64_t memoryLimit = 0;
  int iterations = Options().maxIterations;
  double timeLimit = std::numeric_limits<double>::infinity();
  bool quiet = false;
};

void checkSolver(const std::string& name, const Registry& registry) {
  if (registry.findLinearSystem(name)) return;
  std::vector<std::string> names;
  for (const auto& entry : registry.linearSystems()) names.push_back(entry.name);
  const std::string near = nearestWord(name, names);
  throw UsageError(fmt::format("--solver {}: no such linear solver{}; there are {}", name,
                               near.empty() ? "" : fmt::format(", did you mean '{}'", near), fmt::join(names, ", ")));
}

/// --eliminate: "auto" or "none" alone, or tags.
void checkEliminatedTypes(const std::vector<std::string>& words, const Registry& registry) {
  for (const std::string& word : words) {
    if (word == "auto" || word == "none") {
      if (words.size() > 1) throw UsageError(fmt::format("--eliminate: '{}' stands alone", word));
      continue;
    }
    if (registry.findVertexType(word)) continue;
    std::vector<std::string> tags;
    for (const auto& type : registry.vertexTypes()) tags.push_back(type->tag());
    const std::string near = nearestWord(word, tags);
    throw UsageError(fmt::format("--eliminate {}: no such vertex type{}; it is auto, none or tags of vertex types",
                                 word, near.empty() ? "" : fmt::format(", did you mean '{}'", near)));
  }
}

void applyElimination(const std::vector<std::string>& words, Options& options) {
  if (words.front() == "none") {
    options.elimination = EliminationPolicy::none;
  } else if (words.front() != "auto") {
    options.elimination = EliminationPolicy::types;
    options.eliminatedTypes = words;
  }
}

/// One run of the command.
class Run {
 public:
  explicit Run(const Flags& flags) : flags_(flags) {}

  int run() {
    checkOutputs({flags_.output, flags_.json});
    LoadedGraph loaded = loadGraph(flags_.source);
    report_.loadSeconds = loaded.seconds;
    const Registry& registry = *loaded.graph.registry();
    checkSolver(flags_.solver, registry);
    checkInitialGuess(flags_.init, registry);
    checkEliminatedTypes(flags_.eliminate, registry);
    const std::optional<RobustKernel> kernel =
        flags_.robust.empty() ? std::nullopt : std::optional(parseRobustKernel(flags_.robust, registry));
    for (const std::string& note : readingNotes(flags_.source, loaded.report)) say(note);
    try {
      optimizeGraph(loaded.graph, kernel);
    } catch (const GraphError& error) {
      throw GraphError(fmt::format("{}: {}", displayName(flags_.source.path), error.what()));
    }
    save(loaded);
    const Status status = report_.summary.status;
    if (status == Status::numericalFailure || status == Status::memoryLimit)
      fmt::print(stderr, "{}: {}\n", displayName(flags_.source.path), report_.summary.reason);
    return exitCodeOf(status);
  }

 private:
  /// Where people are told what happens: standard output unless it carries data.
  std::FILE* stream() const {
    if (flags_.quiet) return nullptr;
    return flags_.output == "-" || flags_.json == "-" ? stderr : stdout;
  }
  void say(const std::string& sentence) const {
    if (stream()) fmt::print(stream(), "{}\n", sentence);
  }

  void optimizeGraph(Graph& graph, const std::optional<RobustKernel>& kernel) {
    Overrides overrides(graph);
    overrides.fix(flags_.fix);
    if (kernel) overrides.setRobustKernel(*kernel);
    if (flags_.dialect == Dialect::logarithm) {
      Graph logarithmic = withLogarithmicEdges(graph);
      solve(logarithmic);
      copyEstimates(logarithmic, graph);
    } else {
      solve(graph);
    }
    overrides.takeBack();
  }

  void solve(Graph& graph) {
    Options options = makeOptions();
    Progress progress(stream());
    options.callback = [&progress](const IterationReport& iteration) { progress.iteration(iteration); };
    Stopwatch watch;
    const bool complete = verticesWithoutEstimate(graph) == 0;
    report_.fileChi2 = std::numeric_limits<double>::quiet_NaN();
    if (complete && flags_.init != "file") {
      Problem problem(graph, {.level = options.level, .free = {}, .threads = std::max(options.threads, 1)});
      report_.fileChi2 = problem.evaluate(problem.state()).chi2;
    }
    report_.guess = makeInitialGuess(graph, flags_.init, options);
    report_.initializeSeconds = watch.seconds();
    if (report_.guess.name != "file")
      say(fmt::format("initial guess {}: {}", report_.guess.name, report_.guess.reason));
    options.timeLimit = std::max(0.0, flags_.timeLimit - whole_.seconds());
    report_.summary = optimize(graph, options);
    if (report_.guess.name == "file") report_.fileChi2 = report_.summary.initialChi2;
    progress.finish(report_.summary);
  }

  Options makeOptions() const {
    Options options;
    options.maxIterations = flags_.iterations;
    options.algorithm = flags_.algorithm;
    options.linearSolver = flags_.solver;
    options.gauge = flags_.gauge;
    options.threads = flags_.source.threads;
    options.free = flags_.only;
    options.memoryLimit = flags_.memoryLimit;
    applyElimination(flags_.eliminate, options);
    options.stopToken = interrupt_.token();
    return options;
  }

  void save(const LoadedGraph& loaded) {
    Stopwatch watch;
    if (!flags_.output.empty()) saveGraph(flags_.output, loaded.graph, flags_.source.threads);
    report_.saveSeconds = watch.seconds();
    report_.totalSeconds = whole_.seconds();
    if (!flags_.json.empty()) saveJson(flags_.json, describeRun(report_, describeInput(flags_.source, loaded)));
  }

  const Flags& flags_;
  Stopwatch whole_;
  Interrupt interrupt_;
  OptimizeReport report_;
};

void addSolverFlags(CLI::App& command, Flags& flags) {
  command.add_option("--algorithm", flags.algorithm, "Gauss-Newton (gn), Levenberg-Marquardt (lm), or what fits")
      ->type_name("auto|gn|lm")
      ->check(CLI::IsMember({"auto", "gn", "lm"}).description(""))
      ->capture_default_str();
  command.add_option("--solver", flags.solver, "Linear solver: auto, block, dense, eigen, cholmod, or a plugin's")
      ->type_name("NAME")
      ->capture_default_str();
  command.add_option("--iterations", flags.iterations, "Trial steps at most")
      ->type_name("N")
      ->check(CLI::Range(0, std::numeric_limits<int>::max()).description(""))
      ->capture_default_str();
  command
      .add_option("--init", flags.init,
                  "Initial guess: the file's estimates, a tree, odometry, chordal relaxation, or the best")
      ->type_name("auto|file|tree|odometry|chordal")
      ->capture_default_str();
  command.add_option("--fix", flags.fix, "Vertices to hold fixed, beside the file's FIX lines")
      ->type_name("ID[,ID...]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::NonNegativeNumber.description(""));
  command.add_option("--only", flags.only, "Vertices to move; all others are held")
      ->type_name("ID[,ID...]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::NonNegativeNumber.description(""));
  command
      .add_option("--eliminate", flags.eliminate,
                  "Vertices to eliminate before the rest is solved for: what pays, none, or those of types")
      ->type_name("auto|none|TAG[,TAG...]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->default_str("auto");
  command
      .add_option("--memory-limit", flags.memoryLimit,
                  "Bytes the solve may take beside the graph (suffixes kb, mb, gb); refused before allocation if it "
                  "would take more, exit code 4")
      ->type_name("BYTES")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->check(CLI::PositiveNumber.description(""));
  static const std::map<std::string, GaugePolicy> policies{
      {"auto", GaugePolicy::automatic}, {"fix", GaugePolicy::fix}, {"free", GaugePolicy::free}};
  command
      .add_option("--gauge", flags.gauge,
                  "The world's freedom to move unnoticed: hold a vertex a component, leave it free, or what the "
                  "algorithm needs")
      ->type_name("auto|fix|free")
      ->transform(CLI::CheckedTransformer(policies).description(""))
      ->default_str("auto");
  command
      .add_option("--robust", flags.robust,
                  "Robust kernel of all edges, as huber:1.5; none removes those of the file (see quiver list)")
      ->type_name("NAME[:WIDTH[:SHAPE]]");
  command
      .add_option("--time-limit", flags.timeLimit,
                  "Wall-clock seconds from the start of the command; the best estimate so far is saved, exit code 5")
      ->type_name("SECONDS")
      ->check(CLI::NonNegativeNumber.description(""));
}

}  // namespace

void addOptimizeCommand(CLI::App& parser, int& exitCode) {
  CLI::App* command = parser.add_subcommand("optimize", "Move a graph's vertices to the minimum of its cost");
  auto flags = std::make_shared<Flags>();
  addSourceOptions(*command, flags->source);
  command->add_option("-o,--output", flags->output, "Write the optimised graph here (- is standard output)")
      ->type_name("OUT");
  addSolverFlags(*command, *flags);
  addDialectOption(*command, flags->dialect);
  command->add_option("--json", flags->json, "Write a report of the run here (- is standard output)")
      ->type_name("FILE");
  command->add_flag("--quiet", flags->quiet, "No progress and no summary; errors are told all the same");
  command->footer(
      "Examples:\n"
      "  quiver optimize sphere.g2o -o optimised.g2o\n"
      "  quiver optimize city.g2o.gz --robust huber:1 --json report.json\n"
      "  quiver optimize edges_only.g2o --init tree --algorithm lm --time-limit 10 -o out.g2o\n\n"
      "Exit codes: 0 converged, iteration limit, stalled or nothing to optimise; 1 internal error; 2 usage;\n"
      "3 bad input or plugin; 4 numerical failure or memory limit; 5 interrupted or out of time (best estimate "
      "saved);\n"
      "6 an output cannot be written (found out before solving).");
  command->callback([flags, &exitCode] { exitCode = Run(*flags).run(); });
}

}  // namespace quiver::app
