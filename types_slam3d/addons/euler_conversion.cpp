#include <quiver/types_slam3d/addons/euler_conversion.h>

#include <vector>

#include <fmt/format.h>

#include <quiver/core/util/error.h>
#include <quiver/types_slam3d/addons/edge_se3_euler.h>
#include <quiver/types_slam3d/addons/vertex_se3_euler.h>

namespace quiver {
namespace {

Attachment attachmentOf(const Graph& graph, const void* element) {
  const Attachment* attachment = graph.findAttachment(element);
  return attachment ? *attachment : Attachment{};
}

template <typename Element>
void attach(Graph& graph, const Element& element, const Attachment& lines) {
  if (!lines.before.empty() || !lines.after.empty()) graph.attachment(element) = lines;
}

/// `copy` without the edges of type From, with edges of type To in their place; `replaceVertices` runs in between.
template <typename From, typename To, typename ReplaceVertices>
void replaceEdges(Graph& copy, ReplaceVertices replaceVertices) {
  struct Line {
    std::vector<std::int64_t> ids;
    From edge;
    Attachment lines;
  };
  const EdgeType* from = copy.registry()->findEdgeTypeByName(typeName<From>());
  std::vector<From*> old;
  std::vector<Line> lines;
  copy.forEachEdge([&](Edge& edge) {
    if (&copy.typeOf(edge) != from) return;
    old.push_back(static_cast<From*>(&edge));
    lines.push_back({{edge.vertexIds().begin(), edge.vertexIds().end()}, *old.back(), attachmentOf(copy, &edge)});
  });
  for (From* edge : old) copy.removeEdge(*edge);
  replaceVertices();
  for (const Line& line : lines) {
    const SO3<double> rotation = line.edge.measurement().rotation();
    if (!detail::hasQuaternionChart(rotation) || !detail::hasEulerChart(rotation)) {
      throw GraphError(
          fmt::format("{} {} {} turns by half a turn or pitches by a quarter turn: its information has no "
                      "map between Euler angles and quaternions",
                      from->tag(), line.ids[0], line.ids[1]));
    }
    To& edge = copy.addEdge<To>(line.ids, line.edge.measurement(), line.edge.information());
    edge.setRobustKernel(line.edge.robustKernel());
    edge.setLevel(line.edge.level());
    attach(copy, edge, line.lines);
  }
}

template <typename From, typename To>
void replaceVertices(Graph& copy) {
  const VertexType* from = copy.registry()->findVertexTypeByName(typeName<From>());
  if (!from) return;
  copy.forEachEdge([&](const Edge& edge) {
    for (const std::int64_t id : edge.vertexIds()) {
      if (&copy.typeOf(*copy.findVertex(id)) == from) {
        throw GraphError(fmt::format("{} joins vertex {} ({}), which is to become another type",
                                     copy.typeOf(edge).tag(), id, from->tag()));
      }
    }
  });
  std::vector<From> vertices;
  std::vector<Attachment> lines;
  copy.forEachVertex([&](const Vertex& vertex) {
    if (&copy.typeOf(vertex) != from) return;
    vertices.push_back(static_cast<const From&>(vertex));
    lines.push_back(attachmentOf(copy, &vertex));
  });
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const From& vertex = vertices[i];
    copy.removeVertex(vertex.id());
    To& added = copy.addVertex<To>(vertex.id());
    if (vertex.hasEstimate()) added.setEstimate(vertex.estimate());
    if (vertex.fixed()) added.setFixed(true);
    if (!vertex.fixed() && vertex.fixedDirections() != 0) added.setFixedDirections(vertex.fixedDirections());
    attach(copy, added, lines[i]);
  }
}

template <typename FromVertex, typename FromEdge, typename ToVertex, typename ToEdge>
Graph replaced(const Graph& graph) {
  Graph copy(graph);
  replaceEdges<FromEdge, ToEdge>(copy, [&] { replaceVertices<FromVertex, ToVertex>(copy); });
  return copy;
}

}  // namespace

Graph withEulerAngles(const Graph& graph) { return replaced<VertexSE3, EdgeSE3, VertexSE3Euler, EdgeSE3Euler>(graph); }

Graph withQuaternions(const Graph& graph) { return replaced<VertexSE3Euler, EdgeSE3Euler, VertexSE3, EdgeSE3>(graph); }

}  // namespace quiver
