#include <quiver/solvers/elimination/elimination_plan.h>

#include <algorithm>

#include <quiver/core/util/error.h>
#include <quiver/solvers/elimination/kernels/kernel_table.h>

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;
/// Rows of edges without a point that make a group.
constexpr int freeRows = 8;

/// Points in this order: dimension, number of edges, kinds of edges, the first three kept vertices.
struct PointKey {
  std::uint64_t shape;
  std::uint64_t place;
  std::int32_t point;

  bool operator<(const PointKey& other) const {
    if (shape != other.shape) return shape < other.shape;
    return place != other.place ? place < other.place : point < other.point;
  }
};

}  // namespace

EliminationPlan::EliminationPlan(const Problem& problem, std::span<const char> eliminated) {
  numberKept(problem, eliminated);
  const Incidence incidence = collect(problem, eliminated);
  const std::vector<std::int32_t> order = orderPoints(problem, incidence);
  points_ = static_cast<std::int64_t>(order.size());
  rows_.reserve(incidence.entries.size() / lanes + order.size() / 4 + 16);
  edges_.reserve(rows_.capacity() * lanes);
  incidences_.reserve(rows_.capacity() * lanes);
  groups_.reserve(order.size() / lanes + 16);
  for (std::size_t begin = 0; begin < order.size();) {
    const int dimension = problem.dimension(incidence.points[static_cast<std::size_t>(order[begin])]);
    std::size_t end = begin + 1;
    while (end < order.size() && end < begin + lanes &&
           problem.dimension(incidence.points[static_cast<std::size_t>(order[end])]) == dimension)
      ++end;
    addGroup(problem, incidence, {order.data() + begin, end - begin});
    begin = end;
  }
  pointGroups_ = static_cast<int>(groups_.size());
  addFreeRows(problem, incidence);
  rows_.shrink_to_fit();
  edges_.shrink_to_fit();
  incidences_.shrink_to_fit();
}

void EliminationPlan::numberKept(const Problem& problem, std::span<const char> eliminated) {
  keptOf_.assign(static_cast<std::size_t>(problem.variables()), -1);
  std::vector<int> dimensions;
  for (int variable = 0; variable < problem.variables(); ++variable) {
    if (eliminated[static_cast<std::size_t>(variable)]) continue;
    keptOf_[static_cast<std::size_t>(variable)] = kept();
    keptVariables_.push_back(variable);
    dimensions.push_back(problem.dimension(variable));
  }
  keptLayout_ = BlockLayout(std::move(dimensions));
}

int EliminationPlan::kindOf(const Problem& problem, int batch, int edge, int role) {
  const EdgeBatch& source = problem.batch(batch);
  std::vector<int>& known = kindsOfBatch_[static_cast<std::size_t>(batch)];
  const EdgeShape own = source.uniform() ? EdgeShape{} : source.shape(edge);
  for (const int kind : known) {
    const RowKind& candidate = kinds_[static_cast<std::size_t>(kind)];
    if (candidate.role == role && (source.uniform() || candidate.shape == own)) return kind;
  }
  RowKind kind{batch, role, source.uniform() ? source.largestShape() : own, {}};
  for (int r = 0; r < static_cast<int>(kind.shape.columns.size()); ++r) {
    if (r != role) kind.keptRoles.push_back(r);
  }
  known.push_back(static_cast<int>(kinds_.size()));
  kinds_.push_back(std::move(kind));
  return known.back();
}

EliminationPlan::Incidence EliminationPlan::collect(const Problem& problem, std::span<const char> eliminated) {
  Incidence result;
  std::vector<std::int32_t> pointOf(eliminated.size(), -1);
  for (std::size_t variable = 0; variable < eliminated.size(); ++variable) {
    if (!eliminated[variable]) continue;
    pointOf[variable] = static_cast<std::int32_t>(result.points.size());
    result.points.push_back(static_cast<std::int32_t>(variable));
  }
  const auto pointAt = [&](std::int32_t slot) {
    const int variable = problem.variableOfSlot(slot);
    return variable < 0 ? -1 : pointOf[static_cast<std::size_t>(variable)];
  };
  std::vector<std::int64_t> next(result.points.size() + 2, 0);
  const auto forEachEdge = [&](const auto& visit) {
    for (int b = 0; b < problem.batches(); ++b) {
      const EdgeBatch& batch = problem.batch(b);
      for (int i = 0; i < batch.size(); ++i) {
        const auto slots = batch.slots(i);
        int role = -1;
        for (int r = 0; r < static_cast<int>(slots.size()); ++r) {
          if (pointAt(slots[static_cast<std::size_t>(r)]) < 0) continue;
          if (role >= 0) throw LogicError("an edge joins two vertices that are to be eliminated");
          role = r;
        }
        visit(b, i, role, role < 0 ? -1 : pointAt(slots[static_cast<std::size_t>(role)]));
      }
    }
  };
  kindsOfBatch_.resize(static_cast<std::size_t>(problem.batches()));
  forEachEdge([&](int, int, int role, int point) {
    if (role >= 0) ++next[static_cast<std::size_t>(point) + 2];
  });
  for (std::size_t p = 2; p < next.size(); ++p) next[p] += next[p - 1];
  result.entries.resize(static_cast<std::size_t>(next.back()));
  forEachEdge([&](int b, int i, int role, int point) {
    const int kind = kindOf(problem, b, i, role);
    result.free.resize(kinds_.size());
    if (role < 0) {
      result.free[static_cast<std::size_t>(kind)].push_back(i);
    } else {
      result.entries[static_cast<std::size_t>(next[static_cast<std::size_t>(point) + 1]++)] = {kind, i};
    }
  });
  next.pop_back();
  result.begin = std::move(next);
  const auto byKind = [](const Entry& a, const Entry& b) { return a.kind < b.kind; };
  for (std::size_t p = 0; p < result.points.size(); ++p) {
    Entry* const begin = result.entries.data() + result.begin[p];
    Entry* const end = result.entries.data() + result.begin[p + 1];
    if (!std::is_sorted(begin, end, byKind)) std::stable_sort(begin, end, byKind);
  }
  return result;
}

std::vector<std::int32_t> EliminationPlan::orderPoints(const Problem& problem, const Incidence& incidence) const {
  std::vector<PointKey> keys;
  keys.reserve(incidence.points.size());
  for (std::size_t p = 0; p < incidence.points.size(); ++p) {
    const std::int64_t begin = incidence.begin[p];
    const std::int64_t end = incidence.begin[p + 1];
    std::uint64_t kinds = 0;
    std::uint64_t place = 0;
    int seen = 0;
    for (std::int64_t i = begin; i < end; ++i) {
      const Entry& entry = incidence.entries[static_cast<std::size_t>(i)];
      kinds = (kinds * 31 + static_cast<std::uint64_t>(entry.kind)) & 0xffffff;
      if (seen == 3) continue;
      const RowKind& kind = kinds_[static_cast<std::size_t>(entry.kind)];
      if (kind.keptRoles.empty()) continue;
      const auto slots = problem.batch(kind.batch).slots(entry.edge);
      const int variable = problem.variableOfSlot(slots[static_cast<std::size_t>(kind.keptRoles.front())]);
      const int kept = variable < 0 ? -1 : keptOf(variable);
      place |= (static_cast<std::uint64_t>(std::min(kept + 1, (1 << 21) - 1)) << (42 - 21 * seen));
      ++seen;
    }
    const auto dimension = static_cast<std::uint64_t>(std::min(problem.dimension(incidence.points[p]), 0xffff));
    const auto count = static_cast<std::uint64_t>(std::min<std::int64_t>(end - begin, 0xffffff));
    keys.push_back({dimension << 48 | count << 24 | kinds, place, static_cast<std::int32_t>(p)});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::int32_t> order;
  order.reserve(keys.size());
  for (const PointKey& key : keys) order.push_back(key.point);
  return order;
}

void EliminationPlan::addGroup(const Problem& problem, const Incidence& incidence,
                               std::span<const std::int32_t> points) {
  Group group{};
  group.dimension = problem.dimension(incidence.points[static_cast<std::size_t>(points.front())]);
  group.points.fill(-1);
  std::array<std::int64_t, lanes> next{};
  std::array<std::int64_t, lanes> end{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto p = static_cast<std::size_t>(points[i]);
    group.points[i] = incidence.points[p];
    group.lanes |= 1U << i;
    next[i] = incidence.begin[p];
    end[i] = incidence.begin[p + 1];
  }
  group.sums = sumNumbers_;
  sumNumbers_ += detail::pointNumbers(group.dimension) * lanes;
  group.rowBegin = static_cast<std::int32_t>(rows_.size());
  while (true) {
    int kind = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (next[i] == end[i]) continue;
      const int own = incidence.entries[static_cast<std::size_t>(next[i])].kind;
      if (kind < 0 || own < kind) kind = own;
    }
    if (kind < 0) break;
    std::array<std::int32_t, lanes> edges;
    edges.fill(-1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (next[i] == end[i]) continue;
      const Entry& entry = incidence.entries[static_cast<std::size_t>(next[i])];
      if (entry.kind != kind) continue;
      edges[i] = entry.edge;
      ++next[i];
    }
    addRow(problem, kind, edges);
  }
  group.rowEnd = static_cast<std::int32_t>(rows_.size());
  groups_.push_back(group);
}

void EliminationPlan::addRow(const Problem& problem, int kind, const std::array<std::int32_t, 8>& edges) {
  const RowKind& source = kinds_[static_cast<std::size_t>(kind)];
  Row row{kind, 0, static_cast<std::int64_t>(incidences_.size())};
  std::int32_t present = -1;
  for (int i = 0; i < lanes; ++i) {
    if (edges[static_cast<std::size_t>(i)] < 0) continue;
    row.lanes |= 1U << i;
    present = edges[static_cast<std::size_t>(i)];
  }
  for (const int role : source.keptRoles) {
    for (const std::int32_t edge : edges) {
      const int variable =
          edge < 0 ? -1
                   : problem.variableOfSlot(problem.batch(source.batch).slots(edge)[static_cast<std::size_t>(role)]);
      incidences_.push_back(variable < 0 ? -1 : keptOf(variable));
    }
  }
  for (const std::int32_t edge : edges) edges_.push_back(edge < 0 ? present : edge);
  rows_.push_back(row);
}

void EliminationPlan::addFreeRows(const Problem& problem, const Incidence& incidence) {
  for (std::size_t kind = 0; kind < incidence.free.size(); ++kind) {
    const std::vector<std::int32_t>& list = incidence.free[kind];
    for (std::size_t begin = 0; begin < list.size();) {
      Group group{};
      group.points.fill(-1);
      group.sums = sumNumbers_;
      group.rowBegin = static_cast<std::int32_t>(rows_.size());
      for (int r = 0; r < freeRows && begin < list.size(); ++r, begin += lanes) {
        std::array<std::int32_t, lanes> edges;
        edges.fill(-1);
        std::copy_n(list.data() + begin, std::min<std::size_t>(lanes, list.size() - begin), edges.data());
        addRow(problem, static_cast<int>(kind), edges);
      }
      group.rowEnd = static_cast<std::int32_t>(rows_.size());
      groups_.push_back(group);
    }
  }
}

std::int64_t EliminationPlan::bytes() const {
  return static_cast<std::int64_t>(rows_.size() * sizeof(Row) + groups_.size() * sizeof(Group) + edges_.size() * 4 +
                                   incidences_.size() * 4 + keptOf_.size() * 4 + keptVariables_.size() * 4);
}

}  // namespace quiver
