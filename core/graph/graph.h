#pragma once

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <quiver/core/graph/change_flag.h>
#include <quiver/core/graph/edge.h>
#include <quiver/core/graph/element_pool.h>
#include <quiver/core/graph/id_map.h>
#include <quiver/core/registry/registry.h>

namespace quiver {

namespace detail {
class BulkAdder;
}

/// Text that a file carries and that means nothing to the optimisation: comments before an element, data lines after
/// it.
struct Attachment {
  std::vector<std::string> before;
  std::vector<std::string> after;
};

/// Vertices, edges and parameters by id: what people edit. A value: movable, copyable.
///
/// Elements of one type lie in one pool and never move, so references stay valid until the element is removed.
/// Everything is checked when it is added. Not thread safe while it is changed.
class Graph {
 public:
  /// Shares the registry: the graph keeps the code of its types loaded.
  explicit Graph(std::shared_ptr<const Registry> registry);
  Graph(const Graph& other);
  Graph& operator=(const Graph& other);
  /// The other is empty afterwards.
  Graph(Graph&&) noexcept;
  Graph& operator=(Graph&&) noexcept;
  ~Graph();

  const std::shared_ptr<const Registry>& registry() const { return registry_; }

  /// A new vertex. Throws GraphError if its type is not registered or the id is negative or taken.
  template <typename V>
  V& addVertex(std::int64_t id) {
    return static_cast<V&>(addVertexOf(vertexTypeIndex(typeName<V>(), sizeof(V)), id));
  }
  template <typename V>
  V& addVertex(std::int64_t id, const typename V::Estimate& estimate) {
    V& vertex = addVertex<V>(id);
    vertex.setEstimate(estimate);
    return vertex;
  }
  Vertex& addVertex(const VertexType& type, std::int64_t id) { return addVertexOf(type.index(), id); }

  /// A new edge over existing vertices. Throws GraphError if the type is not registered, a vertex is missing, named
  /// twice or of the wrong type, a parameter is missing or of the wrong type, or the information matrix is none.
  template <typename E>
  E& addEdge(std::initializer_list<std::int64_t> vertices, const typename E::Measurement& measurement,
             const Matrix<double, E::errorDimension, E::errorDimension>& information,
             std::initializer_list<std::int64_t> parameters = {}) {
    return addEdge<E>(std::span(vertices.begin(), vertices.size()), measurement, information,
                      std::span(parameters.begin(), parameters.size()));
  }
  template <typename E>
  E& addEdge(std::span<const std::int64_t> vertices, const typename E::Measurement& measurement,
             const Matrix<double, E::errorDimension, E::errorDimension>& information,
             std::span<const std::int64_t> parameters = {}) {
    detail::requireInformation(information);
    E& edge = static_cast<E&>(addEdgeOf(edgeTypeIndex(typeName<E>(), sizeof(E)), vertices, parameters));
    edge.setMeasurement(measurement);
    storeInformation(edge, information);
    return edge;
  }
  /// The measurement is the type's default, the information the identity.
  Edge& addEdge(const EdgeType& type, std::span<const std::int64_t> vertices,
                std::span<const std::int64_t> parameters = {}) {
    return addEdgeOf(type.index(), vertices, parameters);
  }

  template <typename P>
  P& addParameter(std::int64_t id, const typename P::Value& value) {
    const ParameterType* type = registry_->findParameterTypeByName(typeName<P>());
    if (type) requireSize(*type, sizeof(P));
    P& parameter = static_cast<P&>(addParameterOf(type, typeName<P>(), id));
    parameter.setValue(value);
    return parameter;
  }
  Parameter& addParameter(const ParameterType& type, std::int64_t id) {
    return addParameterOf(&type, type.cppName(), id);
  }

  /// nullptr if there is none.
  Vertex* findVertex(std::int64_t id);
  const Vertex* findVertex(std::int64_t id) const;
  Parameter* findParameter(std::int64_t id);
  const Parameter* findParameter(std::int64_t id) const;
  /// The vertex of that id and type. Throws GraphError if there is none or it is of another type.
  template <typename V>
  V& vertex(std::int64_t id) {
    return static_cast<V&>(checkedVertex(id, typeName<V>(), sizeof(V)));
  }
  template <typename V>
  const V& vertex(std::int64_t id) const {
    return static_cast<const V&>(const_cast<Graph*>(this)->checkedVertex(id, typeName<V>(), sizeof(V)));
  }

  const VertexType& typeOf(const Vertex& vertex) const {
    return *registry_->vertexTypes()[static_cast<std::size_t>(vertex.type())];
  }
  const EdgeType& typeOf(const Edge& edge) const {
    return *registry_->edgeTypes()[static_cast<std::size_t>(edge.type())];
  }
  const ParameterType& typeOf(const Parameter& p) const {
    return *registry_->parameterTypes()[static_cast<std::size_t>(p.type())];
  }

  /// Removes a vertex and every edge on it. O(edges).
  void removeVertex(std::int64_t id) { removeVertices({&id, 1}); }
  /// Removes many at once, which costs as much as one; all or, if one is missing (GraphError), none. O(edges + ids).
  void removeVertices(std::span<const std::int64_t> ids);
  void removeEdge(Edge& edge);

  std::int64_t vertexCount() const { return vertexIds_.size(); }
  std::int64_t edgeCount() const { return edgeCount_; }
  std::int64_t parameterCount() const { return parameterIds_.size(); }
  /// Two stamps read at different times from what is at one address are equal only if it was the same graph both times
  /// and nothing was removed from it meanwhile.
  std::pair<std::int64_t, std::int64_t> stamp() const { return {stamp_.born, stamp_.removals}; }
  /// Another number than the last time if meanwhile elements were added, removed or changed, estimates aside.
  std::uint64_t revision() const { return changeFlag_->revision(); }

  /// Calls visit(vertex) for every vertex, type by type, each type in the order of insertion (removed slots are
  /// reused).
  template <typename Visit>
  void forEachVertex(Visit&& visit) const {
    forEachIn(vertices_, visit, [](const Vertex& v) { return v.id_ >= 0; });
  }
  template <typename Visit>
  void forEachVertex(Visit&& visit) {
    forEachIn(vertices_, visit, [](const Vertex& v) { return v.id_ >= 0; });
  }
  template <typename Visit>
  void forEachEdge(Visit&& visit) const {
    forEachIn(edges_, visit, [](const Edge& e) { return e.alive_; });
  }
  template <typename Visit>
  void forEachEdge(Visit&& visit) {
    forEachIn(edges_, visit, [](const Edge& e) { return e.alive_; });
  }
  template <typename Visit>
  void forEachParameter(Visit&& visit) const {
    forEachIn(parameters_, visit, [](const Parameter& p) { return p.id_ >= 0; });
  }

  /// At most so many edges of that type are here: places that removed ones left count. O(1).
  std::int64_t edgeSlots(const EdgeType& type) const {
    const auto index = static_cast<std::size_t>(type.index());
    return index < edges_.size() && edges_[index] ? edges_[index]->slots() : 0;
  }

  /// Reserves room for elements of a type.
  void reserve(const VertexType& type, std::int64_t count);
  void reserve(const EdgeType& type, std::int64_t count);

  /// Comments and data lines, made on first use; nullptr if there are none.
  Attachment& attachment(const Vertex& vertex);
  Attachment& attachment(const Edge& edge);
  Attachment& attachment(const Parameter& parameter);
  const Attachment* findAttachment(const void* element) const;
  bool hasAttachments() const { return !attachments_.empty(); }
  /// Lines before the first and after the last element.
  Attachment& fileAttachment() { return fileAttachment_; }
  const Attachment& fileAttachment() const { return fileAttachment_; }

 private:
  friend class detail::BulkAdder;

  /// Tells what is at one address after each other apart: graphs by the time at which they came to be there, edges by
  /// the number of removals before, one of which freed their place.
  struct Stamp {
    Stamp() : born(std::chrono::steady_clock::now().time_since_epoch().count()) {}
    Stamp(const Stamp&) : Stamp() {}
    Stamp& operator=(const Stamp&) {
      *this = Stamp();
      return *this;
    }
    Stamp& operator=(Stamp&&) = default;
    bool operator==(const Stamp&) const = default;
    std::int64_t born;
    std::uint32_t removals = 0;
  };

  template <typename Base>
  using Pools = std::vector<std::unique_ptr<ElementPool<Base>>>;

  template <typename PoolList, typename Visit, typename Alive>
  static void forEachIn(PoolList& pools, Visit& visit, Alive alive) {
    for (auto& pool : pools) {
      if (!pool) continue;
      pool->forEach([&](auto& element) {
        if (alive(element)) visit(element);
      });
    }
  }

  template <typename E>
  static void storeInformation(E& edge, const Matrix<double, E::errorDimension, E::errorDimension>& information) {
    const int n = static_cast<int>(information.rows());
    auto& store = edge.informationStore();
    store.resize(n);
    std::size_t k = 0;
    for (int r = 0; r < n; ++r) {
      for (int c = r; c < n; ++c) store.values()[k++] = information(r, c);
    }
  }

  void exchange(Graph& other) noexcept;
  /// Throw GraphError if the type is not registered, or is another one of the same name.
  int vertexTypeIndex(std::string_view cppName, std::size_t size);
  int edgeTypeIndex(std::string_view cppName, std::size_t size) {
    return lastEdgeType_.name == cppName.data() ? lastEdgeType_.index : findEdgeTypeIndex(cppName, size);
  }
  int findEdgeTypeIndex(std::string_view cppName, std::size_t size);
  static void requireSize(const ElementType& type, std::size_t size);
  Vertex& addVertexOf(int type, std::int64_t id);
  Edge& addEdgeOf(int type, std::span<const std::int64_t> vertices, std::span<const std::int64_t> parameters);
  Parameter& addParameterOf(const ParameterType* type, std::string_view cppName, std::int64_t id);
  Vertex& checkedVertex(std::int64_t id, std::string_view cppName, std::size_t size);
  /// What an edge type joins and uses, indices of vertex and parameter types, and where its edges are.
  struct EdgeShape {
    std::vector<int> vertexTypes;
    std::vector<int> parameterTypes;
    bool variableArity = false;
    ElementPool<Edge>* pool = nullptr;
  };
  /// Resolved on first use.
  const EdgeShape& shapeOf(const EdgeType& type);
  const EdgeShape& resolveShape(const EdgeType& type);
  /// Throws GraphError unless an edge of that type may join the vertices and use the parameters. Looks at no element.
  void check(const EdgeType& type, const EdgeShape& shape, std::span<const std::int64_t> vertices,
             std::span<const std::int64_t> parameters) const {
    if (fits(shape, vertices, parameters)) return;
    checkVertices(type, shape, vertices);
    checkParameters(type, shape, parameters);
  }
  /// False if it may not, and for edges of many vertices.
  bool fits(const EdgeShape& shape, std::span<const std::int64_t> vertices,
            std::span<const std::int64_t> parameters) const;
  void checkVertices(const EdgeType& type, const EdgeShape& shape, std::span<const std::int64_t> vertices) const;
  void checkParameters(const EdgeType& type, const EdgeShape& shape, std::span<const std::int64_t> parameters) const;
  void initialize(Vertex& vertex, int type, std::int64_t id) const;
  void initialize(Edge& edge, int type, std::int64_t slot, std::span<const std::int64_t> vertices,
                  std::span<const std::int64_t> parameters) const;
  ElementPool<Vertex>& vertexPool(int type);

  /// The C++ name looked up last and its index: adding many elements of one type looks it up once.
  struct LastType {
    const char* name = nullptr;
    int index = -1;
  };

  std::shared_ptr<const Registry> registry_;
  std::unique_ptr<ChangeFlag> changeFlag_;  // elements keep its address
  Pools<Vertex> vertices_;
  Pools<Edge> edges_;
  Pools<Parameter> parameters_;
  IdMap vertexIds_;
  IdMap parameterIds_;
  std::int64_t edgeCount_ = 0;
  Stamp stamp_;
  std::vector<EdgeShape> shapes_;  // by edge type, made when asked for; a copy makes its own
  LastType lastVertexType_;
  LastType lastEdgeType_;
  std::unordered_map<const void*, Attachment> attachments_;
  Attachment fileAttachment_;
};

/// The estimate of a vertex of known type.
template <typename V>
typename V::Estimate estimateOf(const Vertex& vertex) {
  return static_cast<const V&>(vertex).estimate();
}

}  // namespace quiver
