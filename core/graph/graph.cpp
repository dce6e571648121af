#include <quiver/core/graph/graph.h>

#include <algorithm>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver {
namespace {

template <typename Base>
std::vector<std::unique_ptr<ElementPool<Base>>> clonePools(
    const std::vector<std::unique_ptr<ElementPool<Base>>>& pools) {
  std::vector<std::unique_ptr<ElementPool<Base>>> result;
  result.reserve(pools.size());
  for (const auto& pool : pools) result.push_back(pool ? pool->clone() : nullptr);
  return result;
}

/// The pool of a type, made on first use.
template <typename Base, typename Type>
ElementPool<Base>& poolOf(std::vector<std::unique_ptr<ElementPool<Base>>>& pools, const Type& type) {
  const auto index = static_cast<std::size_t>(type.index());
  if (pools.size() <= index) pools.resize(index + 1);
  if (!pools[index]) pools[index] = type.makePool();
  return *pools[index];
}

/// Elements of a copy belong to it, not to the original.
template <typename Base, typename Join>
void joinAll(const std::vector<std::unique_ptr<ElementPool<Base>>>& pools, const Join& join) {
  for (const auto& pool : pools) {
    for (std::int64_t slot = 0; pool && slot < pool->slots(); ++slot) join(pool->at(slot));
  }
}

/// Moves the keys of attachments from the elements of one graph to those of its copy.
template <typename Base>
void copyAttachments(const std::vector<std::unique_ptr<ElementPool<Base>>>& from,
                     const std::vector<std::unique_ptr<ElementPool<Base>>>& to,
                     const std::unordered_map<const void*, Attachment>& source,
                     std::unordered_map<const void*, Attachment>& target) {
  for (std::size_t p = 0; p < from.size(); ++p) {
    if (!from[p]) continue;
    for (std::int64_t slot = 0; slot < from[p]->slots(); ++slot) {
      const auto it = source.find(&std::as_const(*from[p]).at(slot));
      if (it != source.end()) target.emplace(&to[p]->at(slot), it->second);
    }
  }
}

/// An id that is in the list twice, or nullptr. O(n log n) for lists that are not short.
const std::int64_t* findDuplicate(std::span<const std::int64_t> ids) {
  constexpr std::size_t shortList = 16;
  if (ids.size() <= shortList) {
    for (std::size_t i = 1; i < ids.size(); ++i) {
      const auto before = ids.begin() + static_cast<std::ptrdiff_t>(i);
      if (std::find(ids.begin(), before, ids[i]) != before) return &ids[i];
    }
    return nullptr;
  }
  std::vector<std::int64_t> sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  return twice == sorted.end() ? nullptr : &*std::find(ids.begin(), ids.end(), *twice);
}

}  // namespace

Graph::Graph(std::shared_ptr<const Registry> registry)
    : registry_(std::move(registry)), changeFlag_(std::make_unique<ChangeFlag>()) {
  if (!registry_) throw GraphError("a graph needs a registry");
}

Graph::Graph(const Graph& other)
    : registry_(other.registry_),
      changeFlag_(std::make_unique<ChangeFlag>()),
      vertices_(clonePools(other.vertices_)),
      edges_(clonePools(other.edges_)),
      parameters_(clonePools(other.parameters_)),
      vertexIds_(other.vertexIds_),
      parameterIds_(other.parameterIds_),
      edgeCount_(other.edgeCount_),
      fileAttachment_(other.fileAttachment_) {
  const auto join = [this](auto& element) { element.change_.join(*changeFlag_); };
  joinAll(vertices_, join);
  joinAll(edges_, join);
  joinAll(parameters_, join);
  if (other.attachments_.empty()) return;
  copyAttachments(other.vertices_, vertices_, other.attachments_, attachments_);
  copyAttachments(other.edges_, edges_, other.attachments_, attachments_);
  copyAttachments(other.parameters_, parameters_, other.attachments_, attachments_);
}

Graph& Graph::operator=(const Graph& other) {
  if (this != &other) *this = Graph(other);
  return *this;
}
Graph::Graph(Graph&& other) noexcept : Graph(other.registry_) { exchange(other); }
Graph& Graph::operator=(Graph&& other) noexcept {
  if (this == &other) return *this;
  Graph before(registry_);  // goes with what was here
  before.exchange(*this);
  exchange(other);
  return *this;
}

/// Also the registry, which may own the code of the pools.
void Graph::exchange(Graph& other) noexcept {
  std::swap(changeFlag_, other.changeFlag_);
  std::swap(vertices_, other.vertices_);
  std::swap(edges_, other.edges_);
  std::swap(parameters_, other.parameters_);
  std::swap(vertexIds_, other.vertexIds_);
  std::swap(parameterIds_, other.parameterIds_);
  std::swap(edgeCount_, other.edgeCount_);
  std::swap(shapes_, other.shapes_);
  std::swap(lastVertexType_, other.lastVertexType_);
  std::swap(lastEdgeType_, other.lastEdgeType_);
  std::swap(attachments_, other.attachments_);
  std::swap(fileAttachment_, other.fileAttachment_);
  std::swap(registry_, other.registry_);
  stamp_ = Stamp();
  other.stamp_ = Stamp();
}
Graph::~Graph() = default;

void Graph::requireSize(const ElementType& type, std::size_t size) {
  if (type.objectSize() == size) return;
  throw GraphError(fmt::format(
      "{} is the name of two classes, of {} and {} bytes: the first is registered as '{}'; classes in anonymous "
      "namespaces of two files need names of their own",
      type.cppName(), type.objectSize(), size, type.tag()));
}

int Graph::vertexTypeIndex(std::string_view cppName, std::size_t size) {
  if (lastVertexType_.name == cppName.data()) return lastVertexType_.index;
  const VertexType* type = registry_->findVertexTypeByName(cppName);
  if (!type)
    throw GraphError(
        fmt::format("vertex type {} is not registered: call registry->addVertex<{}>(\"TAG\") first", cppName, cppName));
  requireSize(*type, size);
  lastVertexType_ = {cppName.data(), type->index()};
  return type->index();
}

int Graph::findEdgeTypeIndex(std::string_view cppName, std::size_t size) {
  const EdgeType* type = registry_->findEdgeTypeByName(cppName);
  if (!type)
    throw GraphError(
        fmt::format("edge type {} is not registered: call registry->addEdge<{}>(\"TAG\") first", cppName, cppName));
  requireSize(*type, size);
  lastEdgeType_ = {cppName.data(), type->index()};
  return type->index();
}

Vertex& Graph::addVertexOf(int type, std::int64_t id) {
  if (id < 0) throw GraphError(fmt::format("vertex id {} is negative; ids are 0 or more", id));
  if (vertexIds_.find(id).valid()) throw GraphError(fmt::format("vertex {} exists already", id));
  ElementPool<Vertex>& pool = vertexPool(type);
  const auto [vertex, slot] = pool.add();
  initialize(vertex, type, id);
  vertexIds_.insert(id, {type, static_cast<std::int32_t>(slot)});
  return vertex;
}

Parameter& Graph::addParameterOf(const ParameterType* type, std::string_view cppName, std::int64_t id) {
  if (!type)
    throw GraphError(fmt::format("parameter type {} is not registered: call registry->addParameter first", cppName));
  if (id < 0) throw GraphError(fmt::format("parameter id {} is negative; ids are 0 or more", id));
  if (parameterIds_.find(id).valid()) throw GraphError(fmt::format("parameter {} exists already", id));
  ElementPool<Parameter>& pool = poolOf(parameters_, *type);
  const auto [parameter, slot] = pool.add();
  parameter.id_ = id;
  parameter.change_.join(*changeFlag_);
  parameter.type_ = static_cast<std::uint16_t>(type->index());
  parameterIds_.insert(id, {type->index(), static_cast<std::int32_t>(slot)});
  return parameter;
}

const Graph::EdgeShape& Graph::shapeOf(const EdgeType& type) {
  const auto index = static_cast<std::size_t>(type.index());
  return index < shapes_.size() && shapes_[index].pool != nullptr ? shapes_[index] : resolveShape(type);
}

const Graph::EdgeShape& Graph::resolveShape(const EdgeType& type) {
  const auto index = static_cast<std::size_t>(type.index());
  if (shapes_.size() <= index) shapes_.resize(index + 1);
  EdgeShape shape;
  shape.variableArity = type.variableArity();
  for (int role = 0; role < type.arity(); ++role) {
    const VertexType* vertex = registry_->findVertexTypeByName(type.vertexTypeName(role));
    if (!vertex) {
      throw GraphError(fmt::format("edge {} joins vertices of type {}, which is not registered", type.tag(),
                                   type.vertexTypeName(role)));
    }
    shape.vertexTypes.push_back(vertex->index());
  }
  for (const std::string_view name : type.parameterTypeNames()) {
    const ParameterType* parameter = registry_->findParameterTypeByName(name);
    if (!parameter)
      throw GraphError(fmt::format("edge {} uses parameters of type {}, which is not registered", type.tag(), name));
    shape.parameterTypes.push_back(parameter->index());
  }
  shape.pool = &poolOf(edges_, type);
  return shapes_[index] = std::move(shape);
}

bool Graph::fits(const EdgeShape& shape, std::span<const std::int64_t> vertices,
                 std::span<const std::int64_t> parameters) const {
  constexpr std::size_t few = 3;
  const std::size_t count = vertices.size();
  if (count > few || count != shape.vertexTypes.size() || parameters.size() != shape.parameterTypes.size())
    return false;
  bool good = true;
  for (std::size_t role = 0; role < count; ++role) {
    good = good && vertexIds_.find(vertices[role]).type == shape.vertexTypes[role];
    for (std::size_t before = 0; before < role; ++before) good = good && vertices[before] != vertices[role];
  }
  for (std::size_t i = 0; i < parameters.size(); ++i)
    good = good && parameterIds_.find(parameters[i]).type == shape.parameterTypes[i];
  return good;
}

void Graph::checkVertices(const EdgeType& type, const EdgeShape& shape, std::span<const std::int64_t> vertices) const {
  const std::vector<int>& roles = shape.vertexTypes;
  if (vertices.size() < roles.size() || (vertices.size() > roles.size() && !shape.variableArity)) {
    throw GraphError(fmt::format("edge {} joins {}{} vertices, not {}", type.tag(),
                                 shape.variableArity ? "at least " : "", roles.size(), vertices.size()));
  }
  for (std::size_t role = 0; role < vertices.size(); ++role) {
    const ElementLocation location = vertexIds_.find(vertices[role]);
    if (!location.valid())
      throw GraphError(fmt::format("edge {} names vertex {}, which does not exist", type.tag(), vertices[role]));
    const int expected = roles[std::min(role, roles.size() - 1)];
    if (location.type != expected) {
      throw GraphError(fmt::format("edge {} wants a {} at place {}, but vertex {} is a {}", type.tag(),
                                   registry_->vertexTypes()[static_cast<std::size_t>(expected)]->tag(), role + 1,
                                   vertices[role],
                                   registry_->vertexTypes()[static_cast<std::size_t>(location.type)]->tag()));
    }
  }
  if (const std::int64_t* twice = findDuplicate(vertices)) {
    throw GraphError(fmt::format("edge {} names vertex {} twice", type.tag(), *twice));
  }
}

void Graph::checkParameters(const EdgeType& type, const EdgeShape& shape,
                            std::span<const std::int64_t> parameters) const {
  if (shape.parameterTypes.size() != parameters.size()) {
    throw GraphError(
        fmt::format("edge {} uses {} parameters, not {}", type.tag(), shape.parameterTypes.size(), parameters.size()));
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ElementLocation location = parameterIds_.find(parameters[i]);
    if (!location.valid())
      throw GraphError(fmt::format("edge {} uses parameter {}, which does not exist", type.tag(), parameters[i]));
    if (location.type != shape.parameterTypes[i]) {
      const auto& types = registry_->parameterTypes();
      throw GraphError(fmt::format("edge {} wants a {}, but parameter {} is a {}", type.tag(),
                                   types[static_cast<std::size_t>(shape.parameterTypes[i])]->tag(), parameters[i],
                                   types[static_cast<std::size_t>(location.type)]->tag()));
    }
  }
}

ElementPool<Vertex>& Graph::vertexPool(int type) {
  return poolOf(vertices_, *registry_->vertexTypes()[static_cast<std::size_t>(type)]);
}

void Graph::initialize(Vertex& vertex, int type, std::int64_t id) const {
  vertex.change_.join(*changeFlag_);
  vertex.id_ = id;
  vertex.type_ = static_cast<std::uint16_t>(type);
}

void Graph::initialize(Edge& edge, int type, std::int64_t slot, std::span<const std::int64_t> vertices,
                       std::span<const std::int64_t> parameters) const {
  edge.change_.join(*changeFlag_);
  edge.ids_.assign(vertices, parameters);
  edge.changes_ = std::uint64_t{stamp_.removals} << 32;
  edge.slot_ = static_cast<std::int32_t>(slot);
  edge.type_ = static_cast<std::uint16_t>(type);
  edge.alive_ = true;
}

Edge& Graph::addEdgeOf(int typeIndex, std::span<const std::int64_t> vertices,
                       std::span<const std::int64_t> parameters) {
  const EdgeType& type = *registry_->edgeTypes()[static_cast<std::size_t>(typeIndex)];
  const EdgeShape& shape = shapeOf(type);
  check(type, shape, vertices, parameters);
  const auto [edge, slot] = shape.pool->add();
  initialize(edge, typeIndex, slot, vertices, parameters);
  ++edgeCount_;
  return edge;
}

Vertex* Graph::findVertex(std::int64_t id) {
  const ElementLocation location = vertexIds_.find(id);
  return location.valid() ? &vertices_[static_cast<std::size_t>(location.type)]->at(location.slot) : nullptr;
}
const Vertex* Graph::findVertex(std::int64_t id) const { return const_cast<Graph*>(this)->findVertex(id); }

Parameter* Graph::findParameter(std::int64_t id) {
  const ElementLocation location = parameterIds_.find(id);
  return location.valid() ? &parameters_[static_cast<std::size_t>(location.type)]->at(location.slot) : nullptr;
}
const Parameter* Graph::findParameter(std::int64_t id) const { return const_cast<Graph*>(this)->findParameter(id); }

Vertex& Graph::checkedVertex(std::int64_t id, std::string_view cppName, std::size_t size) {
  Vertex* vertex = findVertex(id);
  if (!vertex) throw GraphError(fmt::format("vertex {} does not exist", id));
  if (typeOf(*vertex).cppName() != cppName) {
    throw GraphError(
        fmt::format("vertex {} is a {} ({}), not a {}", id, typeOf(*vertex).tag(), typeOf(*vertex).cppName(), cppName));
  }
  requireSize(typeOf(*vertex), size);
  return *vertex;
}

void Graph::removeVertices(std::span<const std::int64_t> ids) {
  std::vector<std::int64_t> going(ids.begin(), ids.end());
  std::sort(going.begin(), going.end());
  going.erase(std::unique(going.begin(), going.end()), going.end());
  for (const std::int64_t id : going) {
    if (!vertexIds_.find(id).valid()) throw GraphError(fmt::format("vertex {} does not exist", id));
  }
  const auto goes = [&](std::int64_t id) { return std::binary_search(going.begin(), going.end(), id); };
  std::vector<Edge*> touching;
  forEachEdge([&](Edge& edge) {
    if (std::ranges::any_of(edge.vertexIds(), goes)) touching.push_back(&edge);
  });
  for (Edge* edge : touching) removeEdge(*edge);
  for (const std::int64_t id : going) {
    const ElementLocation location = vertexIds_.find(id);
    ElementPool<Vertex>& pool = *vertices_[static_cast<std::size_t>(location.type)];
    Vertex& vertex = pool.at(location.slot);
    attachments_.erase(&vertex);
    pool.remove(location.slot);
    vertex.id_ = -1;
    ++stamp_.removals;
    vertexIds_.erase(id);
  }
}

void Graph::removeEdge(Edge& edge) {
  ElementPool<Edge>* pool = edge.type_ < edges_.size() ? edges_[edge.type_].get() : nullptr;
  if (!edge.alive_ || !pool || edge.slot_ >= pool->slots() || &pool->at(edge.slot_) != &edge) {
    throw GraphError("an edge that is not of this graph cannot be removed from it");
  }
  attachments_.erase(&edge);
  pool->remove(edge.slot_);
  edge.alive_ = false;
  edge.ids_ = {};
  ++stamp_.removals;
  --edgeCount_;
}

void Graph::reserve(const VertexType& type, std::int64_t count) { poolOf(vertices_, type).reserve(count); }
void Graph::reserve(const EdgeType& type, std::int64_t count) { poolOf(edges_, type).reserve(count); }

Attachment& Graph::attachment(const Vertex& vertex) { return attachments_[&vertex]; }
Attachment& Graph::attachment(const Edge& edge) { return attachments_[&edge]; }
Attachment& Graph::attachment(const Parameter& parameter) { return attachments_[&parameter]; }
const Attachment* Graph::findAttachment(const void* element) const {
  const auto it = attachments_.find(element);
  return it == attachments_.end() ? nullptr : &it->second;
}

namespace detail {

Vertex& vertexOf(Graph& graph, std::int64_t id) { return *graph.findVertex(id); }
const Parameter& parameterOf(const Graph& graph, std::int64_t id) { return *graph.findParameter(id); }
std::span<const double> parameterValues(const Graph& graph, std::int64_t id) {
  const Parameter& parameter = *graph.findParameter(id);
  const ParameterType& type = graph.typeOf(parameter);
  return {type.values(parameter), static_cast<std::size_t>(type.valueCount())};
}

}  // namespace detail
}  // namespace quiver
