#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// A robust kernel as the command line names it: NAME[:WIDTH[:SHAPE]], where WIDTH is a number, or p and a probability
/// from which each edge's width follows by the dimension of its error: huber:p0.95.
class RobustChoice {
 public:
  /// Throws UsageError, with the kernels there are.
  RobustChoice(const std::string& text, const Registry& registry);

  /// The kernel of an edge whose error has that dimension; no kernel for "none".
  RobustKernel kernelFor(int dimension) const;

 private:
  const RobustKernelType* type_ = nullptr;
  double width_ = 1.0;
  std::optional<double> probability_;
  double shape_ = 0.0;
};

/// Edges as the command line names them: "all", "loops" (edges between two vertices of one type whose ids are not
/// consecutive), or tags of edge types, aliases among them.
class EdgeChoice {
 public:
  /// Throws UsageError unless `words` is one of the two words alone or tags of the registry.
  EdgeChoice(const std::vector<std::string>& words, const Registry& registry);

  bool contains(const Graph& graph, const Edge& edge) const;
  /// Whether edges are chosen for closing loops.
  bool loops() const { return words_.front() == "loops"; }
  /// The types that are named; none if edges are not chosen by their types.
  const std::vector<const EdgeType*>& types() const { return types_; }

 private:
  std::vector<std::string> words_;
  std::vector<const EdgeType*> types_;
};

}  // namespace quiver::app
