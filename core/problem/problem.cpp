#include <quiver/core/problem/problem.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include <quiver/core/problem/canonical_order.h>
#include <quiver/core/problem/panel_totals.h>
#include <quiver/core/problem/retraction.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/lane_sums.h>
#include <quiver/core/util/parallel.h>
#include <quiver/core/util/stopwatch.h>

namespace quiver {
namespace {

constexpr int pieceEdges = 256;
/// Edges that run one by one may cost anything: fewer make a piece, so that threads can share them.
constexpr int singleEdges = 16;
/// Nanoseconds, about: what is worth a thread.
constexpr double retractionPerVariable = 15.0;

/// What a row of the batch's first edge takes, the second time it is computed.
RowCost measureRowCost(const EdgeBatch& batch, const State& state) {
  const EdgeShape shape = batch.shape(0);
  if (shape.rows == 0) return {};
  PanelBuffer buffer(batch.largestShape(), true, 1);
  const std::int32_t edge = 0;
  const auto nanoseconds = [&](const auto& compute) {
    compute();
    const Stopwatch watch;
    compute();
    return 1e9 * watch.seconds() / shape.rows;
  };
  RowCost cost;
  cost.evaluate = nanoseconds([&] { batch.evaluate(state, {&edge, 1}, buffer.panel()); });
  cost.linearize = nanoseconds([&] { batch.linearize(state, {&edge, 1}, buffer.panel()); });
  return cost;
}

bool coversAll(std::uint64_t mask, int dimension) {
  const std::uint64_t all = dimension >= 64 ? Vertex::allDirections : (std::uint64_t{1} << dimension) - 1;
  return (mask & all) == all;
}

}  // namespace

Problem::Problem(Graph& graph, const ProblemScope& scope) : graph_(&graph), threads_(std::max(1, scope.threads)) {
  EdgeLists edges = collectEdges(scope);
  SlotLists ends = collectVertices(scope, edges);
  makeBatches(std::move(edges), std::move(ends));
  state_ = State(layout_);
  loadState();
  trial_ = state_;
  measureRowCosts();
  makePanels();
}

Problem::EdgeLists Problem::collectEdges(const ProblemScope& scope) const {
  const std::vector<std::int64_t> free = [&] {
    std::vector<std::int64_t> ids = scope.free;
    std::sort(ids.begin(), ids.end());
    for (const std::int64_t id : ids) {
      if (!graph_->findVertex(id)) throw GraphError(fmt::format("vertex {} is to be optimised but does not exist", id));
    }
    return ids;
  }();
  EdgeLists edges(graph_->registry()->edgeTypes().size());
  if (free.empty()) {
    for (const auto& type : graph_->registry()->edgeTypes())
      edges[static_cast<std::size_t>(type->index())].reserve(static_cast<std::size_t>(graph_->edgeSlots(*type)));
  }
  std::as_const(*graph_).forEachEdge([&](const Edge& edge) {
    if (scope.level >= 0 && edge.level() != scope.level) return;
    if (!free.empty()) {
      const auto ids = edge.vertexIds();
      if (std::none_of(ids.begin(), ids.end(),
                       [&](std::int64_t id) { return std::binary_search(free.begin(), free.end(), id); })) {
        return;
      }
    }
    edges[static_cast<std::size_t>(edge.type())].push_back(&edge);
  });
  for (auto& list : edges) sortEdges(*graph_, list);
  return edges;
}

Problem::SlotLists Problem::findSlots(const ProblemScope& scope, const EdgeLists& edges) {
  std::vector<Vertex*> known;
  if (scope.free.empty()) {
    known.reserve(static_cast<std::size_t>(graph_->vertexCount()));
    graph_->forEachVertex([&](Vertex& vertex) { known.push_back(&vertex); });
  } else {
    for (const auto& list : edges) {
      for (const Edge* edge : list) {
        for (const std::int64_t id : edge->vertexIds()) known.push_back(graph_->findVertex(id));
      }
    }
  }
  sortVertices(*graph_, known);
  const SlotTable places(known);
  std::vector<std::int32_t> slotOf(known.size(), -1);
  SlotLists ends(edges.size());
  constexpr std::size_t remembered = 4;  // edges in order mostly begin with the vertex of the edge before
  for (std::size_t type = 0; type < edges.size(); ++type) {
    if (edges[type].empty()) continue;
    ends[type].reserve(edges[type].size() * static_cast<std::size_t>(edges[type][0]->arity()));
    std::array<std::int64_t, remembered> lastIds;
    std::array<std::int32_t, remembered> lastPlaces;
    lastIds.fill(-1);
    for (const Edge* edge : edges[type]) {
      const auto ids = edge->vertexIds();
      for (std::size_t role = 0; role < ids.size(); ++role) {
        const bool same = role < remembered && lastIds[role] == ids[role];
        const std::int32_t place = same ? lastPlaces[role] : places.find(ids[role]);
        if (!same && role < remembered) {
          lastIds[role] = ids[role];
          lastPlaces[role] = place;
        }
        slotOf[static_cast<std::size_t>(place)] = 0;
        ends[type].push_back(place);
      }
    }
  }
  for (std::size_t place = 0; place < known.size(); ++place) {
    if (slotOf[place] < 0) continue;
    slotOf[place] = static_cast<std::int32_t>(vertices_.size());
    vertices_.push_back(known[place]);
  }
  for (auto& list : ends) {
    for (std::int32_t& end : list) end = slotOf[static_cast<std::size_t>(end)];
  }
  return ends;
}

Problem::SlotLists Problem::collectVertices(const ProblemScope& scope, const EdgeLists& edges) {
  SlotLists ends = findSlots(scope, edges);
  const std::vector<std::int64_t> free = [&] {
    std::vector<std::int64_t> ids = scope.free;
    std::sort(ids.begin(), ids.end());
    return ids;
  }();
  movable_.assign(vertices_.size(), 1);
  for (std::size_t slot = 0; slot < vertices_.size(); ++slot) {
    const Vertex& vertex = *vertices_[slot];
    const VertexType& type = graph_->typeOf(vertex);
    if (!vertex.hasEstimate()) {
      throw GraphError(fmt::format("vertex {} ({}) has no estimate: set one, or run an initial guess first",
                                   vertex.id(), type.tag()));
    }
    layout_.append(type.valueCount(vertex));
    const bool chosen = free.empty() || std::binary_search(free.begin(), free.end(), vertex.id());
    movable_[slot] = chosen && !coversAll(vertex.fixedDirections(), type.dimension(vertex));
  }
  numberVariables(movable_);

  if (static_cast<std::int64_t>(vertices_.size()) != graph_->vertexCount()) {
    std::vector<const Vertex*> known(vertices_.begin(), vertices_.end());
    std::sort(known.begin(), known.end());
    std::as_const(*graph_).forEachVertex([&](const Vertex& vertex) {
      const bool chosen = free.empty() || std::binary_search(free.begin(), free.end(), vertex.id());
      if (chosen && !vertex.fixed() && !std::binary_search(known.begin(), known.end(), &vertex))
        isolated_.push_back(vertex.id());
    });
    std::sort(isolated_.begin(), isolated_.end());
  }
  return ends;
}

void Problem::numberVariables(const std::vector<char>& movable) {
  slotVariables_.assign(vertices_.size(), -1);
  variableSlots_.clear();
  dimensions_.clear();
  offsets_.assign(1, 0);
  held_.clear();
  runs_.clear();
  records_.clear();
  anyHeld_ = false;
  for (std::size_t slot = 0; slot < vertices_.size(); ++slot) {
    if (!movable[slot]) continue;
    const Vertex& vertex = *vertices_[slot];
    const VertexType& type = graph_->typeOf(vertex);
    const int dimension = type.dimension(vertex);
    const auto variable = static_cast<int>(variableSlots_.size());
    if (runs_.empty() || runs_.back().type != &type || dimensions_.back() != dimension)
      runs_.push_back({&type, variable, variable});
    runs_.back().end = variable + 1;
    records_.push_back(layout_.offset(static_cast<int>(slot)));
    slotVariables_[slot] = variable;
    variableSlots_.push_back(static_cast<int>(slot));
    dimensions_.push_back(dimension);
    offsets_.push_back(offsets_.back() + dimension);
    held_.push_back(vertex.fixedDirections());
    anyHeld_ = anyHeld_ || vertex.fixedDirections() != 0;
  }
}

void Problem::holdDirections(std::span<const HeldDirections> holds) {
  std::vector<char> movable(vertices_.size());
  for (std::size_t slot = 0; slot < vertices_.size(); ++slot) movable[slot] = slotVariables_[slot] >= 0;
  std::vector<std::pair<int, std::uint64_t>> partly;  // slot and directions
  for (const HeldDirections& hold : holds) {
    const int slot = slotOfVariable(hold.variable);
    if (coversAll(hold.directions | heldDirections(hold.variable), dimension(hold.variable))) {
      movable[static_cast<std::size_t>(slot)] = 0;
    } else {
      partly.emplace_back(slot, hold.directions);
    }
  }
  numberVariables(movable);
  for (const auto& [slot, directions] : partly) {
    held_[static_cast<std::size_t>(variableOfSlot(slot))] |= directions;
    anyHeld_ = true;
  }
}

void Problem::makeBatches(EdgeLists edges, SlotLists ends) {
  std::vector<int> present;
  for (std::size_t type = 0; type < edges.size(); ++type) {
    if (!edges[type].empty()) present.push_back(static_cast<int>(type));
  }
  for (const int type : edgeTypeOrder(*graph_->registry(), std::move(present))) {
    BatchSource source{*graph_,
                       layout_,
                       std::move(edges[static_cast<std::size_t>(type)]),
                       std::move(ends[static_cast<std::size_t>(type)]),
                       {},
                       threads_};
    const EdgeType& edgeType = *graph_->registry()->edgeTypes()[static_cast<std::size_t>(type)];
    if (edgeType.variableArity()) {
      source.begin = {0};
      source.begin.reserve(source.edges.size() + 1);
      for (const Edge* edge : source.edges) source.begin.push_back(source.begin.back() + edge->arity());
    }
    batches_.push_back(edgeType.makeBatch(source));
    edgeTypes_.push_back(&edgeType);
    const int size = batches_.back()->size();
    edges_ += size;
    const int piece = batches_.back()->rowBytes() > 0 ? pieceEdges : singleEdges;
    for (int begin = 0; begin < size; begin += piece) {
      pieces_.push_back({static_cast<int>(batches_.size()) - 1, begin, std::min(size, begin + piece), {}});
    }
  }
}

void Problem::measureRowCosts() {
  for (const auto& batch : batches_) {
    if (batch->rowBytes() == 0) batch->setRowCost(measureRowCost(*batch, state_));
  }
}

void Problem::makePanels() {
  double nanoseconds = 0.0;
  for (const auto& batch : batches_)
    nanoseconds += batch->rowCost().evaluate * batch->size() * batch->largestShape().rows;
  evaluationThreads_ = worthwhileThreads(threads_, nanoseconds);
  const int tasks = evaluationThreads_ == 1 ? 1 : 4 * evaluationThreads_;
  panels_.resize(static_cast<std::size_t>(tasks));
  for (auto& panels : panels_) {
    for (const auto& batch : batches_)
      panels.emplace_back(batch->largestShape(), false, batch->uniform() ? Panel::capacity : 1);
  }
}

void Problem::setStop(const StopCondition* stop) {
  for (const auto& batch : batches_) batch->setStop(stop);
}

void Problem::loadState() {
  for (int slot = 0; slot < slots(); ++slot) {
    const double* values = vertexType(slot).values(vertex(slot));
    std::copy_n(values, layout_.valueCount(slot), state_.record(slot));
  }
}

void Problem::setRobustCorrection(RobustCorrection correction) {
  for (const auto& batch : batches_) batch->setRobustCorrection(correction);
}

void Problem::refresh(bool estimatesOnly) {
  loadState();
  trial_ = state_;
  if (estimatesOnly) return;
  for (const auto& batch : batches_) batch->refresh(*graph_, threads_);
}

void Problem::store() {
  for (int variable = 0; variable < variables(); ++variable) {
    const int slot = slotOfVariable(variable);
    vertexType(slot).setValues(*vertices_[static_cast<std::size_t>(slot)], state_.record(slot));
  }
}

void Problem::saveBest() {
  if (best_.offsets() == nullptr) best_ = State(layout_);
  best_ = state_;
}

Problem::StepLengths Problem::retract(std::span<const double> delta) {
  constexpr int piece = 256;
  const int count = variables();
  const int threads = worthwhileThreads(threads_, retractionPerVariable * count);
  squares_.resize(static_cast<std::size_t>((count + piece - 1) / piece));
  parallelFor(static_cast<std::int64_t>(squares_.size()), threads, [&](std::int64_t p) {
    const int begin = static_cast<int>(p) * piece;
    const int end = std::min(count, begin + piece);
    const auto first =
        std::partition_point(runs_.begin(), runs_.end(), [&](const Run& run) { return run.end <= begin; });
    for (auto run = first; run != runs_.end() && run->begin < end; ++run) {
      const int from = std::max(begin, run->begin), to = std::min(end, run->end);
      run->type->retractAll({records_.data() + from, to - from, dimension(from), state_.data(),
                             delta.data() + offset(from), trial_.data()});
    }
    const double* const moved = delta.data() + offset(begin);
    const auto scalars = static_cast<std::size_t>(offset(end - 1) + dimension(end - 1) - offset(begin));
    squares_[static_cast<std::size_t>(p)] = {sumInLanes(scalars, [&](std::size_t i) { return moved[i] * moved[i]; }),
                                             squaredValues(begin, end)};
  });
  StepLengths sums{0.0, 0.0};
  for (const StepLengths& own : squares_) {
    sums.step += own.step;
    sums.state += own.state;
  }
  return {std::sqrt(sums.step), std::sqrt(sums.state)};
}

double Problem::squaredValues(int begin, int end) const {
  // Slots between two fixed ones follow each other, and what pads records is zero.
  double sum = 0.0;
  for (int from = begin, to = 0; from < end; from = to) {
    const int first = slotOfVariable(from);
    for (to = from + 1; to < end && slotOfVariable(to) == first + to - from;) ++to;
    const int last = first + to - from - 1;
    const double* const values = state_.record(first);
    const std::ptrdiff_t count = state_.record(last) + layout_.valueCount(last) - values;
    sum += sumInLanes(static_cast<std::size_t>(count), [&](std::size_t i) { return values[i] * values[i]; });
  }
  return sum;
}

CostTotals Problem::evaluate(const State& state) {
  const auto evaluatePiece = [&](Piece& piece, std::vector<PanelBuffer>& panels) {
    const EdgeBatch& batch = *batches_[static_cast<std::size_t>(piece.batch)];
    const Panel& panel = panels[static_cast<std::size_t>(piece.batch)].panel();
    const int step = batch.uniform() ? Panel::capacity : 1;
    PanelTotals totals(piece.batch);
    for (int begin = piece.begin; begin < piece.end; begin += step) {
      const int count = std::min(step, piece.end - begin);
      std::int32_t edges[Panel::capacity];
      std::iota(edges, edges + count, begin);
      batch.evaluate(state, {edges, static_cast<std::size_t>(count)}, panel);
      totals.add(begin, count, panel.squaredError, panel.cost);
    }
    piece.totals = totals.sum();
  };
  const std::int64_t tasks = static_cast<std::int64_t>(panels_.size());
  const std::int64_t count = static_cast<std::int64_t>(pieces_.size());
  parallelFor(tasks, evaluationThreads_, [&](std::int64_t task) {
    for (std::int64_t i = task * count / tasks; i < (task + 1) * count / tasks; ++i) {
      evaluatePiece(pieces_[static_cast<std::size_t>(i)], panels_[static_cast<std::size_t>(task)]);
    }
  });
  CostTotals totals;
  for (const Piece& piece : pieces_) totals.add(piece.totals);
  return totals;
}

}  // namespace quiver
