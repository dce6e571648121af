#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>
#include <quiver/initialization/incidence.h>

namespace quiver::detail {

/// Grows a forest of shortest paths over a graph, telling each vertex it reaches its estimate from the path's last
/// edge. The rules are those of spanningTreeEstimate(); `length` is what an edge adds to a path, ≥ 0 and finite.
class EstimateTree {
 public:
  using Length = double (*)(const EdgeType&, const Edge&);

  EstimateTree(Graph& graph, const Options& options, Length length);

  /// Sets the estimates. Throws GraphError if a vertex ends without one.
  void grow();
  /// From where it grew and what it told, in words.
  std::string describe(const std::string& name) const;

 private:
  /// A path that leads to a vertex by an edge; −1 for a root.
  struct Candidate {
    double distance;
    std::int32_t edges;
    std::int32_t vertex;
    std::int32_t edge;
  };

  /// Forgets what was grown, not the estimates.
  void start();
  void growOnce();
  /// Whether preferPoses() may have something to choose.
  bool posesMissBesideEstimates() const;
  /// Chooses other roots where a pose without an estimate was left over beside landmarks that have one, which cannot
  /// tell it; whether there are such components.
  bool preferPoses();
  void collectVertices(const std::vector<const Edge*>& edges, const std::vector<std::int64_t>& free);
  void findComponents();
  bool isFullPrior(int edge) const;
  void seed();
  void drain();
  /// Makes a vertex known and offers paths over its edges.
  void settle(const Candidate& candidate);
  void offer(const Candidate& candidate);
  bool tell(const Candidate& candidate);
  void plant(int vertex);
  /// False, and no estimate, where the type's origin is none that could be written and read back.
  bool putAtOrigin(int vertex);
  std::vector<std::int32_t> rootOrder() const;
  void plantRemaining();
  void checkAllKnown() const;
  bool later(const Candidate& a, const Candidate& b) const;

  Graph& graph_;
  Length length_;
  std::vector<Vertex*> vertices_;  // in canonical order
  std::vector<char> held_;
  Incidence incidence_;
  std::vector<std::int32_t> componentOf_;
  std::vector<char> rooted_;      // by component
  std::vector<char> estimated_;   // by component: a vertex had an estimate before
  std::vector<char> posesFirst_;  // by component

  std::vector<char> known_;
  std::vector<double> distance_;
  std::vector<std::int32_t> depth_;
  std::vector<std::int32_t> unknown_;  // vertices of each edge that are not known yet
  std::vector<Candidate> heap_;

  std::vector<std::int64_t> roots_;
  std::int64_t told_ = 0;
  std::int64_t kept_ = 0;
  int firstKept_ = -1;
};

}  // namespace quiver::detail
