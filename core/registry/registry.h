#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <quiver/core/registry/element_types.h>

namespace quiver {

class Descent;
class LinearSystem;
class Graph;
struct Options;

/// Makes a linear system for one solve.
using LinearSystemFactory = std::function<std::unique_ptr<LinearSystem>(const Options&)>;
/// Sets estimates of a graph's vertices; returns a sentence for the summary. Throws GraphError if the graph does not
/// allow it.
using Initializer = std::function<std::string(Graph&, const Options&)>;

/// A way from a start to an optimum.
struct Algorithm {
  /// Takes a descent that has begun to its end, by the steps that `core/algorithm/descent.h` offers; returns once
  /// `Descent::ended()`.
  std::function<void(Descent&)> run;
  /// Whether its steps are damped in every direction: then the gauge may stay free.
  bool damped = false;
};

/// A named entry that is not an element type.
template <typename Value>
struct NamedEntry {
  std::string name;
  std::string documentation;
  Value value;
};

/// The types, solvers, algorithms, initialisers and kernels a program knows: an ordinary object, filled explicitly,
/// shared by graphs and plugins. Filling is not thread safe; looking up is.
class Registry {
 public:
  Registry();
  ~Registry();
  Registry(const Registry&) = delete;
  Registry& operator=(const Registry&) = delete;

  /// Makes a vertex type known under a tag. Throws GraphError if the tag or the type is known already.
  template <typename V>
  const VertexType& addVertex(std::string tag, std::string documentation = "");
  template <typename E>
  const EdgeType& addEdge(std::string tag, std::string documentation = "");
  template <typename P>
  const ParameterType& addParameter(std::string tag, std::string documentation = "");

  const VertexType& add(std::unique_ptr<VertexType> type);
  const EdgeType& add(std::unique_ptr<EdgeType> type);
  const ParameterType& add(std::unique_ptr<ParameterType> type);
  /// A second tag for a type when reading; writing uses the first.
  void addAlias(std::string alias, const std::string& tag);
  /// A tag of lines that carry data, not elements: kept verbatim with the element before them.
  void addDataTag(std::string tag, std::string documentation = "");

  /// By tag; nullptr if unknown.
  const VertexType* findVertexType(std::string_view tag) const;
  const EdgeType* findEdgeType(std::string_view tag) const;
  const ParameterType* findParameterType(std::string_view tag) const;
  bool isDataTag(std::string_view tag) const;
  /// By C++ type name; nullptr if unknown.
  const VertexType* findVertexTypeByName(std::string_view cppName) const;
  const EdgeType* findEdgeTypeByName(std::string_view cppName) const;
  const ParameterType* findParameterTypeByName(std::string_view cppName) const;

  const std::vector<std::unique_ptr<VertexType>>& vertexTypes() const { return vertexTypes_; }
  const std::vector<std::unique_ptr<EdgeType>>& edgeTypes() const { return edgeTypes_; }
  const std::vector<std::unique_ptr<ParameterType>>& parameterTypes() const { return parameterTypes_; }
  const std::vector<NamedEntry<int>>& dataTags() const { return dataTags_; }
  const std::vector<std::pair<std::string, std::string>>& aliases() const { return aliases_; }

  /// Linear systems by name ("block", "cholmod", …); a later entry of the same name is refused.
  void addLinearSystem(std::string name, std::string documentation, LinearSystemFactory factory);
  void addInitializer(std::string name, std::string documentation, Initializer initializer);
  /// A value of Options::algorithm beside "auto".
  void addAlgorithm(std::string name, std::string documentation, Algorithm algorithm);
  /// The kernel type is copied nowhere: it must live as long as the registry (a constant of a library that the registry
  /// keeps loaded).
  void addRobustKernel(const RobustKernelType& kernel);

  const std::vector<NamedEntry<LinearSystemFactory>>& linearSystems() const { return linearSystems_; }
  const std::vector<NamedEntry<Initializer>>& initializers() const { return initializers_; }
  const std::vector<NamedEntry<Algorithm>>& algorithms() const { return algorithms_; }
  const std::vector<const RobustKernelType*>& robustKernels() const { return robustKernels_; }
  /// By name without regard to case; nullptr if unknown.
  const LinearSystemFactory* findLinearSystem(std::string_view name) const;
  const Initializer* findInitializer(std::string_view name) const;
  const NamedEntry<Algorithm>* findAlgorithm(std::string_view name) const;
  const RobustKernelType* findRobustKernel(std::string_view name) const;

  /// Keeps a library loaded as long as the registry lives; released after everything else.
  void keepAlive(std::shared_ptr<void> library) { libraries_.push_back(std::move(library)); }

  /// Every tag a file may use, for messages.
  std::vector<std::string> knownTags() const;

 private:
  void claimTag(const std::string& tag) const;

  // Declared first, destroyed last: descriptors below may live in these libraries.
  std::vector<std::shared_ptr<void>> libraries_;
  std::vector<std::unique_ptr<VertexType>> vertexTypes_;
  std::vector<std::unique_ptr<EdgeType>> edgeTypes_;
  std::vector<std::unique_ptr<ParameterType>> parameterTypes_;
  std::vector<NamedEntry<int>> dataTags_;
  std::vector<std::pair<std::string, std::string>> aliases_;
  std::vector<NamedEntry<LinearSystemFactory>> linearSystems_;
  std::vector<NamedEntry<Initializer>> initializers_;
  std::vector<NamedEntry<Algorithm>> algorithms_;
  std::vector<const RobustKernelType*> robustKernels_;
  struct Lookup;
  std::unique_ptr<Lookup> lookup_;
};

/// "did you mean …": the candidate nearest to `word` by edit distance, or an empty string if none is near.
std::string nearestWord(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace quiver

#include <quiver/core/registry/registry_impl.h>
