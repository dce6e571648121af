#include <algorithm>
#include <csignal>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <optional>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/optimize/marginals_file.h>
#include <quiver/apps/optimize/optimize_flags.h>
#include <quiver/apps/optimize/optimize_report.h>
#include <quiver/apps/optimize/overrides.h>
#include <quiver/apps/optimize/progress.h>
#include <quiver/apps/support/counted.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/initial_guess.h>
#include <quiver/apps/support/interrupt.h>
#include <quiver/apps/support/log_dialect.h>
#include <quiver/apps/support/long_work.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/estimates.h>
#include <quiver/core/registry/registry.h>
#include <quiver/core/util/parallel.h>
#include <quiver/core/util/stop_condition.h>
#include <quiver/core/util/stopwatch.h>

namespace quiver::app {
namespace {

/// One run of the command.
class Run {
 public:
  explicit Run(const OptimizeFlags& flags) : flags_(flags), longWork_(flags.quiet) {}

  int run() {
    checkOutputs({flags_.output, flags_.json, flags_.marginals});
    checkInputsSpared({flags_.json, flags_.marginals}, {flags_.source.path});
    longWork_.reading(flags_.source.path);
    std::optional<LoadedGraph> loaded;
    try {
      loaded.emplace(loadGraph(flags_.source));
      if (interrupt_.token().stop_requested()) return endEarly(Status::interrupted, "stopped while reading", *loaded);
      return optimizeLoaded(*loaded);
    } catch (const std::bad_alloc&) {
      if (!loaded) loaded.emplace(LoadedGraph{Graph(std::make_shared<Registry>()), {}, 0.0});
      return endEarly(Status::memoryLimit, "out of memory", *loaded);
    }
  }

 private:
  int optimizeLoaded(LoadedGraph& loaded) {
    longWork_.expect(loaded.graph);
    // Who reads the progress may go away; files that were asked for are written all the same.
    for (const std::string& path : {flags_.output, flags_.json, flags_.marginals}) {
      if (!path.empty() && path != "-") std::signal(SIGPIPE, SIG_IGN);
    }
    report_.loadSeconds = loaded.seconds;
    checkOutputFormat(flags_.output, loaded.graph);
    const Registry& registry = *loaded.graph.registry();
    settleNames(flags_, registry);
    chooseRobustness(registry);
    for (const std::string& note : readingNotes(flags_.source, loaded.report)) say(note);
    try {
      optimizeGraph(loaded.graph);
    } catch (const WorkStopped&) {
      // An initial guess that could not be finished leaves vertices without an estimate, and nothing to save.
      const bool interrupted = interrupt_.token().stop_requested();
      return endEarly(interrupted ? Status::interrupted : Status::timeLimit, "stopped while making the initial guess",
                      loaded);
    } catch (const GraphError& error) {
      throw GraphError(fmt::format("{}: {}", displayName(flags_.source.path), error.what()));
    }
    save(loaded);
    const Status status = report_.summary.status;
    const bool failed = status == Status::numericalFailure || status == Status::memoryLimit;
    if (failed) tell(stderr, "{}: {}\n", displayName(flags_.source.path), report_.summary.reason);
    const ExitCode exit = exitCodeOf(status);
    if (!report_.marginals || report_.marginals->reason.empty()) return exit;
    tell(stderr, "{}: --marginals: {}\n", displayName(flags_.source.path), report_.marginals->reason);
    if (exit != exitSuccess) return exit;
    return report_.marginals->stopped ? exitInterrupted : exitNumericalFailure;
  }

  /// Where people are told what happens: standard output unless it carries data.
  std::FILE* stream() const {
    if (flags_.quiet) return nullptr;
    return flags_.output == "-" || flags_.json == "-" || flags_.marginals == "-" ? stderr : stdout;
  }
  void say(const std::string& sentence) const {
    if (stream()) tell(stream(), "{}\n", sentence);
  }

  /// Ends a run midway: the report alone is written.
  int endEarly(Status status, const char* reason, const LoadedGraph& loaded) {
    tell(stderr, "{}: {}{}\n", displayName(flags_.source.path), reason, saved_ ? "" : "; no estimate is written");
    Summary& summary = report_.summary;
    if (!saved_) {
      constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
      summary.clear();
      summary.threads = flags_.source.threads > 0 ? flags_.source.threads : hardwareThreads();
      summary.initialChi2 = summary.finalChi2 = summary.initialCost = summary.finalCost = unknown;
      report_.fileChi2 = unknown;
    }
    summary.status = status;
    summary.reason = reason;
    report_.loadSeconds = loaded.seconds;
    if (!flags_.marginals.empty()) report_.marginals.emplace().reason = fmt::format("not computed: {}", reason);
    if (!flags_.json.empty()) saveReport(loaded);
    return exitCodeOf(status);
  }

  void chooseRobustness(const Registry& registry) {
    robustEdges_.emplace(flags_.robustEdges, registry);
    if (!flags_.robust.empty()) kernel_.emplace(flags_.robust, registry);
    if (flags_.robust.empty() && flags_.robustEdges.front() != "all")
      throw UsageError("--robust-edges says where a kernel goes: name one with --robust");
  }

  /// structure_only_N: only vertices of N tangent dimensions move.
  void restrictDimension(Graph& graph, Options& options) const {
    if (flags_.onlyDimension == 0) return;
    options.free.clear();
    graph.forEachVertex([&](Vertex& vertex) {
      if (graph.typeOf(vertex).dimension(vertex) == flags_.onlyDimension) options.free.push_back(vertex.id());
    });
    if (options.free.empty())
      throw GraphError(
          fmt::format("no vertex has {}, and others do not move", counted(flags_.onlyDimension, "dimension")));
  }

  /// Calls work(graph) with what the command line adds to the graph, and takes that back.
  template <typename Work>
  void withOverrides(Graph& graph, const Work& work) {
    Overrides overrides(graph);
    overrides.fix(flags_.fix);
    noKernel_ = kernel_ && overrides.setRobustKernels(*kernel_, *robustEdges_) == 0;
    if (flags_.dialect == Dialect::logarithm) {
      Graph logarithmic = withLogarithmicEdges(graph);
      work(logarithmic);
      copyEstimates(logarithmic, graph);
    } else {
      work(graph);
    }
    overrides.takeBack();
  }

  void optimizeGraph(Graph& graph) {
    for (const std::string& note : idleEliminations(flags_, graph)) say(note);
    withOverrides(graph, [this](Graph& changed) {
      if (noKernel_ && robustEdges_->loops())
        say("--robust-edges loops: no edge of the graph closes a loop, so --robust changes nothing");
      solve(changed);
    });
  }

  void solve(Graph& graph) {
    Options options = optionsOf(graph);
    Progress progress(stream());
    options.callback = [&progress](const IterationReport& iteration) { progress.iteration(iteration); };
    options.phase = [this](std::string_view phase) { longWork_.tell(phase); };
    options.timeLimit = std::max(0.0, flags_.timeLimit - whole_.seconds());
    longWork_.tell(fmt::format("initial guess for {} and {}", counted(graph.vertexCount(), "vertex", "vertices"),
                               counted(graph.edgeCount(), "edge")));
    Stopwatch watch;
    Optimizer optimizer(options);
    report_.guess = guessOrKeep(graph, optimizer);
    report_.fileChi2 = report_.guess.fileChi2;
    report_.initializeSeconds = watch.seconds();
    if (report_.guess.name != "file")
      say(fmt::format("initial guess {}: {}", report_.guess.name, report_.guess.reason));
    optimizer.options().timeLimit = std::max(0.0, flags_.timeLimit - whole_.seconds());
    report_.summary = optimizer.optimize(graph);
    if (report_.guess.name == "file") report_.fileChi2 = report_.summary.initialChi2;
    progress.finish(report_.summary);
  }

  /// An initial guess that is stopped leaves the file's estimates, where every vertex has one.
  InitialGuess guessOrKeep(Graph& graph, Optimizer& optimizer) {
    try {
      return makeInitialGuess(graph, flags_.init, optimizer);
    } catch (const WorkStopped&) {
      if (verticesWithoutEstimate(graph) > 0) throw;
      return {"file", fmt::format("the initial guess '{}' was stopped", flags_.init)};
    }
  }

  Options optionsOf(Graph& graph) const {
    Options options = makeOptions(flags_);
    options.stopToken = interrupt_.token();
    restrictDimension(graph, options);
    return options;
  }

  /// Covariances where the descent ended by itself; what keeps them from being had is kept for the end.
  void saveMarginals(Graph& graph) {
    MarginalsReport& report = report_.marginals.emplace();
    if (exitCodeOf(report_.summary.status) != exitSuccess) {
      report.reason = "not computed: the descent did not end at an estimate of its own";
      return;
    }
    longWork_.tell("computing covariances");
    const Stopwatch watch;
    withOverrides(graph, [&](Graph& changed) {
      Options options = optionsOf(changed);
      options.timeLimit = std::max(0.0, flags_.timeLimit - whole_.seconds());
      const Marginals marginals(changed, options);
      report.reason = marginals.reason();
      report.vertices = static_cast<std::int64_t>(marginals.vertices().size());
      report.undetermined = marginals.undetermined();
      report.relativeError = marginals.relativeError();
      if (report.relativeError > 0.1)
        say(fmt::format(
            "--marginals: the system is nearly singular: variances of what is known least may be off by {:.0f} %",
            100.0 * report.relativeError));
      if (marginals.ok()) {
        const Interrupt::Saving saving(flags_.marginals);
        saveText(flags_.marginals, describeMarginals(marginals, changed));
      }
      report.stopped = marginals.stopped();
    });
    report_.marginalsSeconds = watch.seconds();
  }

  void saveReport(const LoadedGraph& loaded) {
    report_.totalSeconds = whole_.seconds();
    const Interrupt::Saving saving(flags_.json);
    saveJson(flags_.json, describeRun(report_, describeInput(flags_.source, loaded)));
  }

  void save(LoadedGraph& loaded) {
    Stopwatch watch;
    // A solve that was refused has no estimate of its own: an older output is worth more.
    if (!flags_.output.empty() && report_.summary.status != Status::memoryLimit) {
      longWork_.tell(fmt::format("saving {}", flags_.output));
      const Interrupt::Saving saving(flags_.output);
      saveGraph(flags_.output, loaded.graph, flags_.source.threads);
      saved_ = true;
    }
    report_.saveSeconds = watch.seconds();
    // Should this file fail, the report is written all the same.
    std::exception_ptr lost;
    try {
      if (!flags_.marginals.empty()) saveMarginals(loaded.graph);
    } catch (const OutputError& error) {
      lost = std::current_exception();
      report_.marginals->reason = error.what();
    }
    if (!flags_.json.empty()) saveReport(loaded);
    if (lost) std::rethrow_exception(lost);
  }

  OptimizeFlags flags_;
  LongWork longWork_;
  Stopwatch whole_;
  Interrupt interrupt_;
  OptimizeReport report_;
  std::optional<RobustChoice> kernel_;
  std::optional<EdgeChoice> robustEdges_;
  /// A kernel was asked for, and no edge has it.
  bool noKernel_ = false;
  /// The output has its estimates.
  bool saved_ = false;
};

}  // namespace

void addOptimizeCommand(CLI::App& parser, int& exitCode) {
  CLI::App* command = parser.add_subcommand("optimize", "Move a graph's vertices to the minimum of its cost");
  auto flags = std::make_shared<OptimizeFlags>();
  addOptimizeFlags(*command, *flags);
  command->footer(
      "Examples:\n"
      "  quiver optimize sphere.g2o -o optimised.g2o\n"
      "  quiver optimize city.g2o.gz --robust huber:1 --json report.json\n"
      "  quiver optimize sphere.g2o --marginals covariances.txt\n"
      "  quiver optimize edges_only.g2o --init tree --algorithm lm --time-limit 10 -o out.g2o\n\n"
      "Exit codes: 0 converged, iteration limit, stalled or nothing to optimise; 1 internal error; 2 usage;\n"
      "3 bad input or plugin; 4 numerical failure or memory limit; 5 interrupted or out of time (best estimate "
      "saved);\n"
      "6 an output cannot be written (found out before solving).");
  command->callback([flags, &exitCode] { exitCode = Run(*flags).run(); });
}

}  // namespace quiver::app
