#include <quiver/solvers/elimination/elimination_choice.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include <quiver/core/util/error.h>
#include <quiver/solvers/assembly/assembly_plan.h>
#include <quiver/solvers/block/factor_pattern.h>
#include <quiver/solvers/block/ordering.h>
#include <quiver/solvers/elimination/clique_pattern.h>
#include <quiver/solvers/elimination/kernels/kernel_table.h>
#include <quiver/solvers/elimination/tile_plan.h>

namespace quiver {
namespace {

/// Automatic elimination takes vertices of at most this dimension: points, not poses.
constexpr int mostDimension = 4;
/// Fewer are not worth a path of their own.
constexpr int leastCount = 16;
/// A type of which less than this can be taken is not one of landmarks.
constexpr double leastShare = 0.7;
/// If so many of the chosen have fewer neighbours than these have, minimum degree would begin with them too.
constexpr double plainShare = 0.9;
/// The elimination of points runs faster than that of as many multiplications in a sparse factorisation.
constexpr double acceptedExcess = 1.2;

/// What one pass over the edges tells.
struct Survey {
  std::vector<int> typeOf;              // of each variable: index of its vertex type
  std::vector<std::int64_t> degree;     // scalars of neighbours, counted with their edges
  std::vector<std::int64_t> units;      // memory that the vertex's records would take
  std::vector<std::vector<char>> join;  // whether an edge joins two variables of these types

  explicit Survey(const Problem& problem) {
    const std::size_t variables = static_cast<std::size_t>(problem.variables());
    for (int v = 0; v < problem.variables(); ++v)
      typeOf.push_back(problem.vertexType(problem.slotOfVariable(v)).index());
    degree.assign(variables, 0);
    units.assign(variables, 0);
    const std::size_t types = problem.graph().registry()->vertexTypes().size();
    join.assign(types, std::vector<char>(types, 0));
    forEachPair(problem, [&](int u, int v) {
      degree[static_cast<std::size_t>(u)] += problem.dimension(v);
      units[static_cast<std::size_t>(u)] += detail::recordSize(problem.dimension(v), problem.dimension(u)) / 8;
      join[static_cast<std::size_t>(typeOf[static_cast<std::size_t>(u)])]
          [static_cast<std::size_t>(typeOf[static_cast<std::size_t>(v)])] = 1;
    });
  }

  /// Calls visit(u, v) for every ordered pair of variables of every edge.
  template <typename Visit>
  static void forEachPair(const Problem& problem, const Visit& visit) {
    std::vector<int> variables;
    for (int b = 0; b < problem.batches(); ++b) {
      const EdgeBatch& batch = problem.batch(b);
      for (int i = 0; i < batch.size(); ++i) {
        variables.clear();
        for (const std::int32_t slot : batch.slots(i)) {
          if (const int variable = problem.variableOfSlot(slot); variable >= 0) variables.push_back(variable);
        }
        for (const int u : variables) {
          for (const int v : variables) {
            if (u != v) visit(u, v);
          }
        }
      }
    }
  }
};

/// Builds the independent set type by type.
class Chooser {
 public:
  Chooser(const Problem& problem, const Options& options)
      : problem_(problem), automatic_(options.elimination == EliminationPolicy::automatic), survey_(problem) {
    choice_.eliminated.assign(static_cast<std::size_t>(problem.variables()), 0);
    members_.resize(survey_.join.size());
    for (int v = 0; v < problem.variables(); ++v)
      members_[static_cast<std::size_t>(survey_.typeOf[static_cast<std::size_t>(v)])].push_back(v);
  }

  EliminationChoice run(const Options& options) {
    for (const int type : candidates(options)) tryType(type);
    if (choice_.count == 0) {
      choice_.reason = !automatic_        ? "no vertex of the named types can move"
                       : !reason_.empty() ? reason_
                       : tooFew()         ? fmt::format("vertices of no small type are as many as {}", leastCount)
                                          : "no type of small vertices is free of edges among themselves";
      return std::move(choice_);
    }
    if (automatic_ && !worthwhile()) {
      choice_.eliminated.assign(choice_.eliminated.size(), 0);
      choice_.count = 0;
      choice_.types.clear();
    }
    choice_.reason = reason_;
    return std::move(choice_);
  }

 private:
  const VertexType& type(int index) const {
    return *problem_.graph().registry()->vertexTypes()[static_cast<std::size_t>(index)];
  }

  /// Whether there are small vertices, of each type fewer than what pays.
  bool tooFew() const {
    bool any = false;
    for (int t = 0; t < static_cast<int>(members_.size()); ++t) {
      const auto count = static_cast<int>(members_[static_cast<std::size_t>(t)].size());
      if (count == 0 || dimensionOf(t) > mostDimension) continue;
      if (count >= leastCount) return false;
      any = true;
    }
    return any;
  }

  std::vector<int> candidates(const Options& options) const {
    std::vector<int> list;
    if (automatic_) {
      for (int t = 0; t < static_cast<int>(members_.size()); ++t) {
        const auto& members = members_[static_cast<std::size_t>(t)];
        if (static_cast<int>(members.size()) >= leastCount && dimensionOf(t) <= mostDimension) list.push_back(t);
      }
    } else {
      for (const std::string& tag : options.eliminatedTypes) {
        const VertexType* found = problem_.graph().registry()->findVertexType(tag);
        if (found == nullptr) throw GraphError(fmt::format("eliminatedTypes names '{}', which is no vertex type", tag));
        if (std::find(list.begin(), list.end(), found->index()) == list.end()) list.push_back(found->index());
      }
    }
    std::sort(list.begin(), list.end(), [&](int a, int b) {
      if (dimensionOf(a) != dimensionOf(b)) return dimensionOf(a) < dimensionOf(b);
      const auto countA = members_[static_cast<std::size_t>(a)].size();
      const auto countB = members_[static_cast<std::size_t>(b)].size();
      return countA != countB ? countA > countB : type(a).tag() < type(b).tag();
    });
    return list;
  }

  /// The largest dimension of a type's variables.
  int dimensionOf(int t) const {
    int largest = 0;
    for (const int v : members_[static_cast<std::size_t>(t)]) largest = std::max(largest, problem_.dimension(v));
    return largest;
  }

  void tryType(int t) {
    const std::vector<int>& members = members_[static_cast<std::size_t>(t)];
    const auto& joined = survey_.join[static_cast<std::size_t>(t)];
    bool conflicts = joined[static_cast<std::size_t>(t)] != 0;
    for (const int other : chosenTypes_) conflicts = conflicts || joined[static_cast<std::size_t>(other)] != 0;
    std::vector<int> taken;
    if (conflicts) {
      taken = independent(members);
    } else {
      for (const int v : members) {
        if (fits(v)) taken.push_back(v);
      }
    }
    if (automatic_) {
      const std::size_t possible = taken.size();
      leaveHighDegrees(taken);
      if (static_cast<double>(taken.size()) < leastShare * static_cast<double>(members.size()) ||
          static_cast<int>(taken.size()) < leastCount) {
        if (reason_.empty()) {
          reason_ =
              fmt::format("of {} {}, {} can be eliminated at once, of which {} have fewer neighbours than those have",
                          members.size(), type(t).tag(), possible, taken.size());
        }
        return;
      }
    }
    if (taken.empty()) return;
    for (const int v : taken) choice_.eliminated[static_cast<std::size_t>(v)] = 1;
    choice_.count += static_cast<std::int64_t>(taken.size());
    choice_.types.push_back(type(t).tag());
    chosenTypes_.push_back(t);
  }

  /// Whether a point's records fit a tile.
  bool fits(int v) const { return survey_.units[static_cast<std::size_t>(v)] <= TilePlan::mostUnits; }

  /// Greedy by degree: a vertex is taken unless a neighbour was.
  std::vector<int> independent(std::vector<int> members) {
    buildNeighbours();
    std::stable_sort(members.begin(), members.end(), [&](int a, int b) {
      return survey_.degree[static_cast<std::size_t>(a)] < survey_.degree[static_cast<std::size_t>(b)];
    });
    std::vector<char> chosen = choice_.eliminated;
    std::vector<int> taken;
    for (const int v : members) {
      const auto begin = static_cast<std::size_t>(begin_[static_cast<std::size_t>(v)]);
      const auto end = static_cast<std::size_t>(begin_[static_cast<std::size_t>(v) + 1]);
      const bool free = std::none_of(neighbours_.begin() + static_cast<std::ptrdiff_t>(begin),
                                     neighbours_.begin() + static_cast<std::ptrdiff_t>(end),
                                     [&](int other) { return chosen[static_cast<std::size_t>(other)] != 0; });
      if (!free || !fits(v)) continue;
      chosen[static_cast<std::size_t>(v)] = 1;
      taken.push_back(v);
    }
    std::sort(taken.begin(), taken.end());
    return taken;
  }

  void buildNeighbours() {
    if (!begin_.empty()) return;
    begin_.assign(static_cast<std::size_t>(problem_.variables()) + 1, 0);
    Survey::forEachPair(problem_, [&](int u, int) { ++begin_[static_cast<std::size_t>(u) + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    neighbours_.resize(static_cast<std::size_t>(begin_.back()));
    std::vector<std::int64_t> next(begin_.begin(), begin_.end() - 1);
    Survey::forEachPair(problem_, [&](int u, int v) {
      neighbours_[static_cast<std::size_t>(next[static_cast<std::size_t>(u)]++)] = v;
    });
  }

  /// Removes vertices with more neighbours than the least of theirs has, and counts the others as plain.
  void leaveHighDegrees(std::vector<int>& taken) {
    std::vector<std::int64_t> least(survey_.degree.size(), std::numeric_limits<std::int64_t>::max());
    Survey::forEachPair(problem_, [&](int u, int v) {
      least[static_cast<std::size_t>(u)] =
          std::min(least[static_cast<std::size_t>(u)], survey_.degree[static_cast<std::size_t>(v)]);
    });
    const auto modest = [&](int v) {
      return survey_.degree[static_cast<std::size_t>(v)] <= least[static_cast<std::size_t>(v)];
    };
    plain_ += std::count_if(taken.begin(), taken.end(), modest);
    // Vertices of few neighbours do little harm even where these are poorer still.
    std::erase_if(taken, [&](int v) { return !modest(v) && survey_.degree[static_cast<std::size_t>(v)] > highDegree; });
  }

  /// Multiplications and additions that eliminating the chosen takes.
  double pointFlops() const {
    double flops = 0.0;
    for (int v = 0; v < problem_.variables(); ++v) {
      if (!choice_.eliminated[static_cast<std::size_t>(v)]) continue;
      const double e = problem_.dimension(v);
      const auto k = static_cast<double>(survey_.degree[static_cast<std::size_t>(v)]);
      flops += e * e * e / 3.0 + e * e * k + e * k * k;
    }
    return flops;
  }

  bool worthwhile() {
    const std::int64_t rest = problem_.variables() - choice_.count;
    if (rest == 0) {
      reason_ = fmt::format("{} {} are independent of each other and nothing else moves", choice_.count, names());
      return true;
    }
    if (static_cast<double>(plain_) >= plainShare * static_cast<double>(choice_.count)) {
      reason_ = fmt::format("{} {} have fewer neighbours than those have and leave a system of {} vertices",
                            choice_.count, names(), rest);
      return true;
    }
    const BlockLayout whole(std::vector<int>(problem_.dimensions().begin(), problem_.dimensions().end()));
    const BlockPattern pattern = BlockPattern::fromPairs(whole, AssemblyPlan::variablePairs(problem_));
    const double without = predictFactor(pattern, amdOrdering(pattern).order).flops;
    const EliminationPlan plan(problem_, choice_.eliminated);
    const BlockPattern reduced = cliquePattern(plan.keptLayout(), PointNeighbours(plan), directPairs(plan));
    const double with = pointFlops() + predictFactor(reduced, amdOrdering(reduced).order).flops;
    const bool taken = with <= acceptedExcess * without;
    reason_ =
        fmt::format("eliminating {} {} first takes {:.3g} operations, a sparse factorisation of everything {:.3g}",
                    choice_.count, names(), with, without);
    return taken;
  }

  std::string names() const {
    std::string text;
    for (const std::string& tag : choice_.types) text += (text.empty() ? "" : " and ") + tag;
    return text;
  }

  /// Scalars of neighbours up to which a vertex may be eliminated whatever its neighbours' degrees.
  static constexpr std::int64_t highDegree = 36;

  const Problem& problem_;
  bool automatic_;
  Survey survey_;
  EliminationChoice choice_;
  std::vector<std::vector<int>> members_;
  std::vector<int> chosenTypes_;
  std::vector<std::int64_t> begin_;
  std::vector<int> neighbours_;
  std::int64_t plain_ = 0;
  std::string reason_;
};

}  // namespace

EliminationChoice chooseElimination(const Problem& problem, const Options& options) {
  if (options.elimination == EliminationPolicy::none) {
    EliminationChoice choice;
    choice.eliminated.assign(static_cast<std::size_t>(problem.variables()), 0);
    choice.reason = "as asked";
    return choice;
  }
  EliminationChoice choice = Chooser(problem, options).run(options);
  if (options.elimination == EliminationPolicy::types && choice.count > 0) choice.reason = "as asked";
  return choice;
}

}  // namespace quiver
