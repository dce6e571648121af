#include <quiver/apps/optimize/optimize_flags.h>

#include <map>

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <quiver/apps/optimize/named_types.h>
#include <quiver/apps/optimize/solver_names.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/initial_guess.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/core/algorithm/algorithms.h>
#include <quiver/core/registry/registry.h>

namespace quiver::app {
namespace {

/// Throws UsageError for a word that is none of those there are.
[[noreturn]] void refuseWord(const std::string& flag, const std::string& word, const char* what,
                             const std::vector<std::string>& candidates, const std::string& advice) {
  const std::string near = nearestWord(word, candidates);
  throw UsageError(fmt::format("{} {}: no such {}{}; {}", flag, word, what,
                               near.empty() ? "" : fmt::format(", did you mean '{}'", near), advice));
}

void checkSolver(const std::string& name, const Registry& registry) {
  if (registry.findLinearSystem(name)) return;
  std::vector<std::string> names;
  for (const auto& entry : registry.linearSystems()) names.push_back(entry.name);
  refuseWord("--solver", name, "linear solver", names, fmt::format("there are {}", fmt::join(names, ", ")));
}

/// --eliminate: "auto" or "off" alone, or tags.
void checkEliminatedTypes(const std::vector<std::string>& words, const Registry& registry) {
  for (const std::string& word : words) {
    if (word == "auto" || word == "off") {
      if (words.size() > 1) throw UsageError(fmt::format("--eliminate: '{}' stands alone", word));
      continue;
    }
    if (registry.findVertexType(word)) continue;
    std::vector<std::string> tags;
    for (const auto& type : registry.vertexTypes()) tags.push_back(type->tag());
    refuseWord("--eliminate", word, "vertex type", tags, "it is auto, off or tags of vertex types");
  }
}

void applyElimination(const std::vector<std::string>& words, Options& options) {
  if (words.front() == "off") {
    options.elimination = EliminationPolicy::none;
  } else if (words.front() != "auto") {
    options.elimination = EliminationPolicy::types;
    options.eliminatedTypes = words;
  }
}

/// A name of g2o's sets algorithm and solver together; flags given beside it would contradict it.
void resolveAlgorithm(OptimizeFlags& flags, const Registry& registry) {
  if (flags.algorithm == "auto" || findAlgorithm(registry, flags.algorithm)) return;
  const SolverName* entry = findSolverName(flags.algorithm);
  if (!entry) {
    std::vector<std::string> names = algorithmNames(registry);
    const std::string advice =
        fmt::format("there are {} and g2o's solver names (see quiver list)", fmt::join(names, ", "));
    for (const SolverName& known : solverNames()) names.emplace_back(known.name);
    refuseWord("--algorithm", flags.algorithm, "algorithm", names, advice);
  }
  if (flags.solver != "auto") {
    throw UsageError(fmt::format("--algorithm {} chooses the linear solver {}; leave --solver {} away", entry->name,
                                 entry->solver, flags.solver));
  }
  flags.algorithm = entry->algorithm;
  flags.solver = entry->solver;
  flags.onlyDimension = entry->onlyDimension;
  if (!entry->init.empty() && flags.init == "auto") flags.init = entry->init;
}

void addAlgorithmFlags(CLI::App& command, OptimizeFlags& flags) {
  command
      .add_option("--algorithm", flags.algorithm,
                  "Gauss-Newton (gn), Levenberg-Marquardt (lm), Powell's dogleg, or what fits; a plugin's; or a solver "
                  "name of g2o's, as lm_var_cholmod")
      ->type_name("auto|gn|lm|dogleg|NAME")
      ->capture_default_str();
  command
      .add_option("--solver", flags.solver,
                  "Linear solver: auto, block, dense, eigen, cholmod, pcg, power, or a plugin's")
      ->type_name("NAME")
      ->capture_default_str();
  command
      .add_option(
          "--linear-tolerance", flags.linearTolerance,
          "Residual, as a part of the right-hand side, at which an iterative linear solver ends near the optimum; "
          "steps far from it, which the next ones correct anyway, end earlier; power adds at most 20 terms, 10000 "
          "where nothing is "
          "eliminated")
      ->type_name("R")
      ->check(numberBetween(1e-16, 0.999))
      ->capture_default_str();
  command.add_option("--iterations", flags.iterations, "Trial steps at most")
      ->type_name("N")
      ->transform(wholeNumber(0))
      ->capture_default_str();
  addList(command, "--eliminate", flags.eliminate,
          "Vertices to eliminate before the rest is solved for: what pays, off for none, or those of types",
          filled("the list"))
      ->type_name("auto|off|TAG[,TAG...]")
      ->default_str("auto");
  command
      .add_option("--memory-limit", flags.memoryLimit,
                  "Bytes the solve may take beside the graph (suffixes kb, mb, gb); refused before allocation if it "
                  "would take more, exit code 4")
      ->type_name("BYTES")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->check(numberFrom(1));
}

void addStartFlags(CLI::App& command, OptimizeFlags& flags) {
  command
      .add_option(
          "--init", flags.init,
          "Initial guess: the file's estimates, a tree, odometry, chordal relaxation, measured points, or the best")
      ->type_name("auto|file|tree|odometry|chordal|points")
      ->capture_default_str();
  addList(command, "--fix", flags.fix, "Vertices to hold fixed, beside the file's FIX lines", vertexId())
      ->type_name("ID[,ID...]");
  addList(command, "--only", flags.only,
          "Vertices to move; all others are held, and only edges on these take part and count in chi2", vertexId())
      ->type_name("ID[,ID...]");
  static const std::map<std::string, GaugePolicy> policies{
      {"auto", GaugePolicy::automatic}, {"fix", GaugePolicy::fix}, {"free", GaugePolicy::free}};
  command
      .add_option("--gauge", flags.gauge,
                  "The world's freedom to move unnoticed: hold a vertex a component, leave it free, or what the "
                  "algorithm needs")
      ->type_name("auto|fix|free")
      ->transform(wordOf(policies))
      ->default_str("auto");
}

void addRobustFlags(CLI::App& command, OptimizeFlags& flags) {
  command
      .add_option(
          "--robust", flags.robust,
          "Robust kernel, as huber:1.5; huber:p0.95 takes the width that 95 % of good measurements stay within; "
          "none removes those of the file (see quiver list)")
      ->type_name("NAME[:WIDTH[:SHAPE]]")
      ->check(filled("the name of the kernel"));
  addList(command, "--robust-edges", flags.robustEdges,
          "Edges that --robust is for: all, loop closures (two vertices of one type, ids not consecutive), or those of "
          "types",
          filled("the list"))
      ->type_name("all|loops|TAG[,TAG...]")
      ->default_str("all");
  static const std::map<std::string, RobustCorrection> corrections{{"first", RobustCorrection::first},
                                                                   {"second", RobustCorrection::second}};
  command
      .add_option("--robust-correction", flags.robustCorrection,
                  "How kernels enter the normal equations: by their weight, or by their curvature too (Triggs), where "
                  "that leaves them positive")
      ->type_name("first|second")
      ->transform(wordOf(corrections))
      ->default_str("first");
}

}  // namespace

void addOptimizeFlags(CLI::App& command, OptimizeFlags& flags) {
  addSourceOptions(command, flags.source);
  command.add_option("-o,--output", flags.output, "Write the optimised graph here (- is standard output)")
      ->type_name("OUT")
      ->check(outputPath());
  addAlgorithmFlags(command, flags);
  addStartFlags(command, flags);
  addRobustFlags(command, flags);
  command
      .add_option("--time-limit", flags.timeLimit,
                  "Wall-clock seconds from the start of the command; the best estimate so far is saved, exit code 5")
      ->type_name("SECONDS")
      ->check(numberFrom(0));
  addDialectOption(command, flags.dialect);
  command
      .add_option(
          "--marginals", flags.marginals,
          "Write the covariance of every vertex that moves here (- is standard output): tag, id, upper triangle. "
          "The gauge is held for it unless --gauge free says not to, but where vertices are fixed only if --gauge fix "
          "asks for it")
      ->type_name("FILE")
      ->check(outputPath());
  command
      .add_option("--json", flags.json,
                  "Write a report of the run here, for the exit codes 4 and 5 too (- is standard output)")
      ->type_name("FILE")
      ->check(outputPath());
  command.add_flag("--quiet", flags.quiet, "No progress and no summary; errors are told all the same");
}

void settleNames(OptimizeFlags& flags, const Registry& registry) {
  resolveAlgorithm(flags, registry);
  checkSolver(flags.solver, registry);
  checkInitialGuess(flags.init, registry);
  checkEliminatedTypes(flags.eliminate, registry);
}

std::vector<std::string> idleEliminations(const OptimizeFlags& flags, const Graph& graph) {
  std::vector<std::string> notes;
  for (const std::string& word : flags.eliminate) {
    const VertexType* type = graph.registry()->findVertexType(word);
    const std::string missing = type ? missingType(graph, *type) : "";
    if (!missing.empty()) notes.push_back(fmt::format("--eliminate {}: {}", word, missing));
  }
  return notes;
}

Options makeOptions(const OptimizeFlags& flags) {
  Options options;
  options.maxIterations = flags.iterations;
  options.algorithm = flags.algorithm;
  options.linearSolver = flags.solver;
  options.gauge = flags.gauge;
  options.threads = flags.source.threads;
  options.free = flags.only;
  options.memoryLimit = flags.memoryLimit;
  options.robustCorrection = flags.robustCorrection;
  options.linearTolerance = flags.linearTolerance;
  applyElimination(flags.eliminate, options);
  return options;
}

}  // namespace quiver::app
