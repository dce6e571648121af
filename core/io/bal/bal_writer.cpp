#include <quiver/core/io/bal/bal_writer.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <quiver/core/io/bal/bal_format.h>
#include <quiver/core/io/text/number_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/parallel.h>

namespace quiver::detail {
namespace {

/// Elements that one task formats, and tasks between two writes.
constexpr std::size_t itemsPerTask = 4096;
constexpr std::size_t tasksPerWrite = 64;

/// Writes numbers with a separator before each.
class SeparatedWriter final : public FieldWriter {
 public:
  SeparatedWriter(NumberWriter& out, char before, char after) : out_(out), before_(before), after_(after) {}
  void real(double value) override {
    if (!std::isfinite(value)) throw GraphError(fmt::format("an element holds the value {}, which no file can", value));
    if (before_) out_.character(before_);
    out_.real(value);
    if (after_) out_.character(after_);
  }
  void integer(std::int64_t) override { throw LogicError("a number of a bundle adjustment file is an integer"); }
  void word(std::string_view) override { throw LogicError("a number of a bundle adjustment file is a word"); }

 private:
  NumberWriter& out_;
  char before_;
  char after_;
};

[[noreturn]] void refuse(const std::string& reason) {
  throw GraphError("a bundle adjustment file (.bal) cannot hold " + reason);
}

void checkEdge(const Graph& graph, const BalTypes& types, const Edge& edge) {
  const EdgeType& type = graph.typeOf(edge);
  if (&type != types.observation) refuse(fmt::format("an edge {}", type.tag()));
  const std::span<const double> information = type.information(edge);
  if (information[0] != 1.0 || information[1] != 0.0 || information[2] != 1.0) {
    refuse(fmt::format("an information matrix that is not the identity, as that of {} {} {}", type.tag(),
                       edge.vertexId(0), edge.vertexId(1)));
  }
  if (edge.robustKernel()) refuse(fmt::format("robust kernels, as {} on an edge", edge.robustKernel().name()));
  if (edge.level() != 0) refuse(fmt::format("levels, as {} of an edge", edge.level()));
}

class BalWriter {
 public:
  BalWriter(const Graph& graph, int threads, FunctionRef<void(std::string_view)> sink)
      : types_(*graph.registry()), threads_(threads > 0 ? threads : hardwareThreads()), sink_(sink) {
    graph.forEachVertex([&](const Vertex& vertex) {
      (&graph.typeOf(vertex) == types_.camera ? cameras_ : points_).push_back(&vertex);
    });
    edges_.reserve(static_cast<std::size_t>(graph.edgeCount()));
    graph.forEachEdge([&](const Edge& edge) { edges_.push_back(&edge); });
    for (auto* list : {&cameras_, &points_}) {
      std::sort(list->begin(), list->end(), [](const Vertex* a, const Vertex* b) { return a->id() < b->id(); });
      for (std::size_t i = 0; i < list->size(); ++i)
        indices_.insert((*list)[i]->id(), {0, static_cast<std::int32_t>(i)});
    }
  }

  void run() {
    sink_(fmt::format("{} {} {}\n", cameras_.size(), points_.size(), edges_.size()));
    write(edges_, [&](const Edge& edge, NumberWriter& out) {
      out.integer(indices_.find(edge.vertexId(0)).slot);
      out.character(' ');
      out.integer(indices_.find(edge.vertexId(1)).slot);
      SeparatedWriter writer(out, ' ', 0);
      types_.observation->write(edge, writer);
      out.character('\n');
    });
    const auto vertices = [&](const VertexType& type) {
      return [&type](const Vertex& vertex, NumberWriter& out) {
        SeparatedWriter writer(out, 0, '\n');
        type.write(vertex, writer);
      };
    };
    write(cameras_, vertices(*types_.camera));
    write(points_, vertices(*types_.point));
  }

 private:
  template <typename Element, typename Format>
  void write(const std::vector<const Element*>& elements, Format format) {
    std::vector<NumberWriter> texts(tasksPerWrite);
    std::vector<std::optional<GraphError>> errors(tasksPerWrite);
    for (std::size_t first = 0; first < elements.size(); first += itemsPerTask * tasksPerWrite) {
      const std::size_t left = elements.size() - first;
      const std::size_t tasks = std::min(tasksPerWrite, (left + itemsPerTask - 1) / itemsPerTask);
      parallelFor(static_cast<std::int64_t>(tasks), threads_, [&](std::int64_t task) {
        const auto t = static_cast<std::size_t>(task);
        const std::size_t begin = first + t * itemsPerTask;
        texts[t].clear();
        try {
          for (std::size_t i = begin; i < std::min(begin + itemsPerTask, elements.size()); ++i)
            format(*elements[i], texts[t]);
        } catch (const GraphError& error) {
          errors[t] = error;
        }
      });
      for (std::size_t t = 0; t < tasks; ++t) {
        if (errors[t]) throw *errors[t];
        sink_(texts[t].view());
      }
    }
  }

  const BalTypes types_;
  int threads_;
  FunctionRef<void(std::string_view)> sink_;
  std::vector<const Vertex*> cameras_;
  std::vector<const Vertex*> points_;
  std::vector<const Edge*> edges_;
  /// From an id to the index among its kind.
  IdMap indices_;
};

}  // namespace

void checkBal(const Graph& graph) {
  const BalTypes types(*graph.registry());
  if (graph.parameterCount() > 0) refuse("parameters");
  graph.forEachVertex([&](const Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    if (&type != types.camera && &type != types.point) refuse(fmt::format("vertex {}, a {}", vertex.id(), type.tag()));
    if (!vertex.hasEstimate()) refuse(fmt::format("vertex {} ({}), which has no estimate", vertex.id(), type.tag()));
    if (vertex.fixedDirections() != 0) refuse(fmt::format("fixed vertices, as {} ({})", vertex.id(), type.tag()));
  });
  graph.forEachEdge([&](const Edge& edge) { checkEdge(graph, types, edge); });
}

void writeBal(const Graph& graph, int threads, FunctionRef<void(std::string_view)> sink) {
  checkBal(graph);
  BalWriter(graph, threads, sink).run();
}

}  // namespace quiver::detail
