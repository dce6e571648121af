#include <quiver/smoothing/marginals.h>

#include <algorithm>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <quiver/core/algorithm/diagnosis.h>
#include <quiver/core/algorithm/gauge_policy.h>
#include <quiver/core/problem/problem.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/parallel.h>
#include <quiver/smoothing/selected_inverse.h>
#include <quiver/solvers/assembly/assembler.h>
#include <quiver/solvers/assembly/assembly_plan.h>
#include <quiver/solvers/block/ordering.h>
#include <quiver/solvers/normal_equations.h>

namespace quiver {

struct Marginals::Contents {
  /// What is known of a vertex: a variable has a block of the inverse, a constant none.
  struct Known {
    enum class Kind { variable, constant, unseen, undetermined };
    Kind kind = Kind::constant;
    int dimension = 0;
    int variable = -1;
    std::int64_t offset = 0;
    std::uint64_t held = 0;
  };

  GaugeReport gauge;
  std::string reason;
  bool stopped = false;
  SelectedInverse inverse;
  std::unordered_map<std::int64_t, Known> vertices;
  std::int64_t scalars = 0;
  double relativeError = 0.0;

  void compute(Graph& graph, const Options& options);
  void list(const Problem& problem);
  void invert(Problem& problem, const Options& options);
  void estimateError(const Problem& problem, const BlockMatrix& matrix, std::span<const double> diagonal);
  std::string describeFailure(const Problem& problem, const Options& options) const;
  std::vector<std::int64_t> idsOf(Known::Kind kind) const;
  const Known& known(std::int64_t id) const;
  Eigen::MatrixXd block(std::int64_t a, std::int64_t b) const;
};

namespace {

/// Rows of directions that are held are zero.
void clearHeld(std::uint64_t held, Eigen::MatrixXd& block) {
  for (Eigen::Index i = 0; held != 0 && i < block.rows() && i < 64; ++i) {
    if (held >> i & 1) block.row(i).setZero();
  }
}

/// Which variables share an edge with a vertex that does not move.
std::vector<char> besideConstants(const Problem& problem) {
  std::vector<char> beside(static_cast<std::size_t>(problem.variables()), 0);
  for (int b = 0; b < problem.batches(); ++b) {
    for (int i = 0; i < problem.batch(b).size(); ++i) {
      const auto slots = problem.batch(b).slots(i);
      const auto variable = [&](std::int32_t slot) { return problem.variableOfSlot(slot); };
      if (std::all_of(slots.begin(), slots.end(), [&](std::int32_t slot) { return variable(slot) >= 0; })) continue;
      for (const std::int32_t slot : slots) {
        if (variable(slot) >= 0) beside[static_cast<std::size_t>(variable(slot))] = 1;
      }
    }
  }
  return beside;
}

}  // namespace

void Marginals::Contents::compute(Graph& graph, const Options& options) {
  Problem problem(graph, {options.level, options.free, options.threads > 0 ? options.threads : hardwareThreads()});
  problem.setRobustCorrection(options.robustCorrection);
  Options holding = options;
  if (holding.gauge == GaugePolicy::automatic) holding.gauge = GaugePolicy::fix;
  // Where vertices are fixed, the others are known relative to these or, unless more is to be held, not at all.
  const std::vector<char> anchored = besideConstants(problem);
  const auto floats = [&](const ComponentGauge& component) {
    return options.gauge == GaugePolicy::fix ||
           std::none_of(component.variables.begin(), component.variables.end(),
                        [&](int v) { return anchored[static_cast<std::size_t>(v)]; });
  };
  if (problem.variables() > 0) settleGauge(problem, holding, false, gauge, floats);
  list(problem);
  if (problem.variables() > 0) invert(problem, options);
}

void Marginals::Contents::list(const Problem& problem) {
  const Graph& graph = problem.graph();
  graph.forEachVertex(
      [&](const Vertex& vertex) { vertices[vertex.id()].dimension = graph.typeOf(vertex).dimension(vertex); });
  for (const std::int64_t id : problem.isolated()) vertices[id].kind = Known::Kind::unseen;
  for (int v = 0; v < problem.variables(); ++v) {
    Known& vertex = vertices[problem.vertex(problem.slotOfVariable(v)).id()];
    vertex = {Known::Kind::variable, problem.dimension(v), v, problem.offset(v), problem.heldDirections(v)};
  }
  scalars = problem.scalars();
}

void Marginals::Contents::invert(Problem& problem, const Options& options) {
  const BlockLayout layout(std::vector<int>(problem.dimensions().begin(), problem.dimensions().end()));
  BlockMatrix matrix(
      std::make_shared<const BlockPattern>(BlockPattern::fromPairs(layout, AssemblyPlan::variablePairs(problem))));
  std::vector<double> gradient(static_cast<std::size_t>(scalars));
  std::vector<double> diagonal(static_cast<std::size_t>(scalars));
  const StopCondition stop(options.timeLimit, options.stopToken);
  const std::int64_t bytes = options.memoryLimit > 0 ? SelectedInverse::predictBytes(matrix.pattern()) : 0;
  if (bytes > options.memoryLimit) {
    reason = fmt::format("covariances would take about {} bytes, {} are allowed", bytes, options.memoryLimit);
    return;
  }
  PhaseSeconds seconds;
  Assembler assembler(problem, matrix, naturalOrdering(problem.variables()).order, problem.threads());
  const CostTotals totals = assembler.assemble(problem.state(), matrix, gradient, diagonal, seconds);
  if (!totals.finite()) {
    const Edge& edge = problem.batch(totals.badBatch).edge(totals.badEdge);
    reason = fmt::format("covariances do not exist: the error of edge {} {} is not finite",
                         problem.edgeType(totals.badBatch).tag(), fmt::join(edge.vertexIds(), " "));
    return;
  }
  inverse = SelectedInverse(matrix, stop);
  if (inverse.stopped()) {
    stopped = true;
    reason = stop.reason() == StopCondition::Reason::timeLimit
                 ? "the time limit was reached while covariances were computed"
                 : "interrupted while covariances were computed";
    return;
  }
  for (const SelectedInverse::Pinned& pinned : inverse.pinned()) {
    for (const int variable : pinned.moved)
      vertices[problem.vertex(problem.slotOfVariable(variable)).id()].kind = Known::Kind::undetermined;
  }
  if (idsOf(Known::Kind::variable).empty()) {
    reason = describeFailure(problem, options);
  } else {
    estimateError(problem, matrix, diagonal);
  }
}

void Marginals::Contents::estimateError(const Problem& problem, const BlockMatrix& matrix,
                                        std::span<const double> diagonal) {
  double largest = 0.0;
  std::int64_t least = -1;  // known scalar, in units of its own
  for (int v = 0; v < problem.variables(); ++v) {
    if (vertices[problem.vertex(problem.slotOfVariable(v)).id()].kind != Known::Kind::variable) continue;
    const Eigen::MatrixXd own = *inverse.find(v, v);
    for (Eigen::Index i = 0; i < own.rows(); ++i) {
      const std::int64_t at = problem.offset(v) + i;
      const double share = own(i, i) * diagonal[static_cast<std::size_t>(at)];
      if (!(share > largest)) continue;
      largest = share;
      least = at;
    }
  }
  if (least < 0) return;
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(scalars);
  unit[least] = 1.0;
  const Eigen::VectorXd z = inverse.solve(unit);
  double size = 0.0;
  const BlockPattern& pattern = matrix.pattern();
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k) {
      const int row = pattern.row(k);
      const auto rows = z.segment(problem.offset(row), problem.dimension(row)).cwiseAbs();
      const auto columns = z.segment(problem.offset(column), problem.dimension(column)).cwiseAbs();
      const Eigen::Map<const Eigen::MatrixXd> block(matrix.block(k), rows.size(), columns.size());
      size += (row == column ? 1.0 : 2.0) * rows.dot(block.cwiseAbs() * columns);
    }
  }
  relativeError = std::numeric_limits<double>::epsilon() * size / z[least];
}

std::vector<std::int64_t> Marginals::Contents::idsOf(Known::Kind kind) const {
  std::vector<std::int64_t> ids;
  for (const auto& [id, vertex] : vertices) {
    if (vertex.kind == kind) ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

std::string Marginals::Contents::describeFailure(const Problem& problem, const Options& options) const {
  NormalEquations equations;
  Options unlimited = options;
  unlimited.memoryLimit = 0;  // less is needed than was just there
  equations.analyze(problem, unlimited, problem.threads());
  equations.linearize(problem.state());
  const LinearOutcome outcome{.kind = LinearOutcome::Kind::notPositiveDefinite,
                              .variable = inverse.pinned().front().block,
                              .coordinate = inverse.pinned().front().coordinate};
  // Told as to a damped descent: damping is no remedy for a covariance that does not exist.
  return "covariances do not exist: " + diagnoseFailure(problem, equations, outcome, true);
}

const Marginals::Contents::Known& Marginals::Contents::known(std::int64_t id) const {
  const auto found = vertices.find(id);
  if (found == vertices.end()) throw GraphError(fmt::format("no vertex {}: it has no covariance", id));
  if (found->second.kind == Known::Kind::unseen)
    throw GraphError(fmt::format("vertex {} is free and no active edge touches it: it has no covariance", id));
  if (found->second.kind == Known::Kind::undetermined)
    throw GraphError(fmt::format("vertex {} is not constrained in every direction: it has no covariance", id));
  return found->second;
}

Eigen::MatrixXd Marginals::Contents::block(std::int64_t a, std::int64_t b) const {
  if (!reason.empty()) throw GraphError(reason);
  const Known& row = known(a);
  const Known& column = known(b);
  if (row.kind == Known::Kind::constant || column.kind == Known::Kind::constant)
    return Eigen::MatrixXd::Zero(row.dimension, column.dimension);
  Eigen::MatrixXd block;
  if (auto selected = inverse.find(row.variable, column.variable)) {
    block = std::move(*selected);
  } else {
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(scalars, column.dimension);
    unit.middleRows(column.offset, column.dimension).setIdentity();
    block = inverse.solve(unit).middleRows(row.offset, row.dimension);
  }
  clearHeld(row.held, block);
  Eigen::MatrixXd transposed = block.transpose();
  clearHeld(column.held, transposed);
  return transposed.transpose();
}

Marginals::Marginals(Graph& graph, const Options& options) : contents_(std::make_unique<Contents>()) {
  options.validate();
  contents_->compute(graph, options);
}
Marginals::~Marginals() = default;
Marginals::Marginals(Marginals&&) noexcept = default;
Marginals& Marginals::operator=(Marginals&&) noexcept = default;

bool Marginals::ok() const { return contents_->reason.empty(); }
const std::string& Marginals::reason() const { return contents_->reason; }
bool Marginals::stopped() const { return contents_->stopped; }
double Marginals::relativeError() const { return contents_->relativeError; }
const GaugeReport& Marginals::gauge() const { return contents_->gauge; }

std::vector<std::int64_t> Marginals::vertices() const {
  return ok() ? contents_->idsOf(Contents::Known::Kind::variable) : std::vector<std::int64_t>();
}
std::vector<std::int64_t> Marginals::undetermined() const {
  std::vector<std::int64_t> ids = contents_->idsOf(Contents::Known::Kind::undetermined);
  const std::vector<std::int64_t> unseen = contents_->idsOf(Contents::Known::Kind::unseen);
  ids.insert(ids.end(), unseen.begin(), unseen.end());
  std::sort(ids.begin(), ids.end());
  return ids;
}

int Marginals::dimension(std::int64_t id) const {
  if (!contents_->reason.empty()) throw GraphError(contents_->reason);
  return contents_->known(id).dimension;
}

void Marginals::copyBlock(std::int64_t a, std::int64_t b, double* out) const {
  const Eigen::MatrixXd block = contents_->block(a, b);
  std::copy_n(block.data(), block.size(), out);
}

void Marginals::copyJoint(std::span<const std::int64_t> ids, double* out) const {
  Eigen::Index scalars = 0;
  for (const std::int64_t id : ids) scalars += contents_->known(id).dimension;
  Eigen::Map<Eigen::MatrixXd> joint(out, scalars, scalars);
  Eigen::Index column = 0;
  for (std::size_t j = 0; j < ids.size(); ++j) {
    Eigen::Index row = column;
    for (std::size_t i = j; i < ids.size(); ++i) {
      const Eigen::MatrixXd block = contents_->block(ids[i], ids[j]);
      joint.block(row, column, block.rows(), block.cols()) = block;
      joint.block(column, row, block.cols(), block.rows()) = block.transpose();
      row += block.rows();
    }
    column += contents_->known(ids[j]).dimension;
  }
}

}  // namespace quiver
