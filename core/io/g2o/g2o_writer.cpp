#include <quiver/core/io/g2o/g2o_writer.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>
#include <vector>

#include <fmt/format.h>

#include <quiver/core/io/bal/bal_writer.h>
#include <quiver/core/io/csv/csv_writer.h>
#include <quiver/core/io/files/output_file.h>
#include <quiver/core/io/text/number_writer.h>
#include <quiver/core/io/toro/toro_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/parallel.h>

namespace quiver {
namespace {

/// Elements that one task formats, and tasks between two writes.
constexpr std::size_t itemsPerTask = 2048;
constexpr std::size_t tasksPerWrite = 64;

/// One of the three.
struct Item {
  const Parameter* parameter = nullptr;
  const Vertex* vertex = nullptr;
  const Edge* edge = nullptr;
  bool operator<(const Item& other) const {
    return parameter ? parameter->id() < other.parameter->id() : vertex->id() < other.vertex->id();
  }
};

class ElementWriter final : public FieldWriter {
 public:
  ElementWriter(const Graph& graph, const WriteOptions& options, NumberWriter& out)
      : graph_(graph), annotations_(options.annotations), toro_(options.format == GraphFormat::toro), out_(out) {}

  void real(double value) override {
    if (!std::isfinite(value)) throw GraphError(fmt::format("{} holds the value {}, which no file can", what_, value));
    out_.character(' ');
    out_.real(value);
  }
  void integer(std::int64_t value) override {
    out_.character(' ');
    out_.integer(value);
  }
  void word(std::string_view value) override {
    if (value.empty() || value.find_first_of(" \t\r\n") != std::string_view::npos) {
      throw GraphError(fmt::format("{} holds the word '{}', which is not one word", what_, value));
    }
    out_.character(' ');
    out_.text(value);
  }

  void write(const Item& item) {
    if (item.parameter) writeParameter(*item.parameter);
    if (item.vertex) writeVertex(*item.vertex);
    if (item.edge) writeEdge(*item.edge);
  }

  /// Text that was attached: never a line that would be read as an element.
  void lines(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) {
      if (line.find('\n') != std::string::npos) throw GraphError("a comment or data line may not hold a line's end");
      const std::size_t begin = line.find_first_not_of(" \t\r");
      const std::string word =
          begin == std::string::npos ? "" : line.substr(begin, line.find_first_of(" \t\r", begin) - begin);
      const Registry& registry = *graph_.registry();
      if (word == "FIX" || word == "#quiver" || registry.findVertexType(word) || registry.findEdgeType(word) ||
          registry.findParameterType(word))
        throw GraphError(
            fmt::format("the attached line '{}' would be read as an element, or as what quiver says of one", line));
      out_.text(line);
      out_.character('\n');
    }
  }

  /// Text before an element is comments: a data line would belong to the element above.
  void comments(const std::vector<std::string>& texts) {
    for (const std::string& line : texts) {
      const std::size_t begin = line.find_first_not_of(" \t\r");
      if (begin != std::string::npos && line[begin] != '#')
        throw GraphError(fmt::format("the line '{}' before an element is no comment: begin it with #", line));
    }
    lines(texts);
  }

  void fix(const Vertex& vertex) {
    out_.text("FIX");
    integer(vertex.id());
    out_.character('\n');
  }

  static bool fullyFixed(const Vertex& vertex, int dimension) {
    return vertex.fixed() || (dimension > 0 && dimension <= 64 && (~vertex.fixedDirections() << (64 - dimension)) == 0);
  }

 private:
  std::string_view tag(const ElementType& type) const { return toro_ ? detail::toroTag(type.tag()) : type.tag(); }
  const Attachment* begin(const void* element) {
    const Attachment* attachment = graph_.findAttachment(element);
    if (attachment) comments(attachment->before);
    return attachment;
  }
  void endLine(const Attachment* attachment) {
    out_.character('\n');
    if (attachment) lines(attachment->after);
  }

  void writeParameter(const Parameter& parameter) {
    const ParameterType& type = graph_.typeOf(parameter);
    what_ = fmt::format("parameter {} ({})", parameter.id(), type.tag());
    const Attachment* attachment = begin(&parameter);
    out_.text(type.tag());
    integer(parameter.id());
    type.write(parameter, *this);
    endLine(attachment);
  }

  void writeVertex(const Vertex& vertex) {
    const VertexType& type = graph_.typeOf(vertex);
    if (!vertex.hasEstimate() && !annotations_) return;
    what_ = fmt::format("vertex {} ({})", vertex.id(), type.tag());
    const Attachment* attachment = begin(&vertex);
    if (!vertex.hasEstimate()) out_.text("#quiver vertex ");
    out_.text(tag(type));
    integer(vertex.id());
    if (vertex.hasEstimate()) type.write(vertex, *this);
    endLine(attachment);
    writeFixed(vertex, type.dimension(vertex));
  }

  void writeFixed(const Vertex& vertex, int dimension) {
    if (fullyFixed(vertex, dimension)) return fix(vertex);
    const int bits = dimension > 0 ? std::min(dimension, 64) : 64;
    const std::uint64_t mask = vertex.fixedDirections() << (64 - bits) >> (64 - bits);
    if (mask == 0 || !annotations_) return;
    out_.text("#quiver fixed");
    for (int i = 0; i < bits; ++i) {
      if (mask >> i & 1) integer(i);
    }
    out_.character('\n');
  }

  void writeEdge(const Edge& edge) {
    const EdgeType& type = graph_.typeOf(edge);
    what_ = type.tag();
    for (const std::int64_t id : edge.vertexIds()) what_ += fmt::format(" {}", id);
    const Attachment* attachment = begin(&edge);
    out_.text(tag(type));
    for (const std::int64_t id : edge.vertexIds()) integer(id);
    if (type.variableArity()) out_.text(" ||");
    for (const std::int64_t id : edge.parameterIds()) integer(id);
    if (toro_) {
      detail::writeToroEdge(type, edge, *this);
    } else {
      type.write(edge, *this);
      if (type.hasInformationField()) reals(type.information(edge));
      type.writeTail(edge, *this);
    }
    out_.character('\n');
    if (annotations_) writeMarks(edge);
    if (attachment) lines(attachment->after);
  }

  void writeMarks(const Edge& edge) {
    if (const RobustKernel& kernel = edge.robustKernel()) {
      if (graph_.registry()->findRobustKernel(kernel.name()) != kernel.type()) {
        throw GraphError(
            fmt::format("edge {}: robust kernel '{}' is not of the graph's registry, so that no reader would know it; "
                        "registry->addRobustKernel makes it so",
                        what_, kernel.name()));
      }
      out_.text("#quiver kernel");
      word(kernel.name());
      real(kernel.width());
      if (kernel.type()->hasShape) real(kernel.shape());
      out_.character('\n');
    }
    if (edge.level() != 0) {
      out_.text("#quiver level");
      integer(edge.level());
      out_.character('\n');
    }
  }

  const Graph& graph_;
  bool annotations_;
  bool toro_;
  NumberWriter& out_;
  /// The element being written, for messages.
  std::string what_;
};

/// Whether the vertices would come back from the edges alone.
bool edgesTellVertices(const Graph& graph) {
  bool untouched = true;
  graph.forEachVertex([&](const Vertex& vertex) {
    const bool whole =
        vertex.fixedDirections() == 0 || ElementWriter::fullyFixed(vertex, graph.typeOf(vertex).dimension(vertex));
    untouched = untouched && !vertex.hasEstimate() && whole && !graph.findAttachment(&vertex);
  });
  if (!untouched) return false;
  std::unordered_set<std::int64_t> named;
  graph.forEachEdge([&](const Edge& edge) { named.insert(edge.vertexIds().begin(), edge.vertexIds().end()); });
  return static_cast<std::int64_t>(named.size()) == graph.vertexCount();
}

class G2oWriter {
 public:
  G2oWriter(const Graph& graph, const WriteOptions& options, FunctionRef<void(std::string_view)> sink)
      : graph_(graph),
        options_(options),
        threads_(options.threads > 0 ? options.threads : hardwareThreads()),
        vertices_(!edgesTellVertices(graph)),
        sink_(sink) {}

  void run() {
    NumberWriter text;
    ElementWriter writer(graph_, options_, text);
    writer.lines(graph_.fileAttachment().before);
    sink_(text.view());
    writeItems(collect());
    text.clear();
    if (!vertices_) {
      std::vector<const Vertex*> fixed;
      graph_.forEachVertex([&](const Vertex& vertex) {
        if (vertex.fixedDirections() != 0) fixed.push_back(&vertex);
      });
      std::sort(fixed.begin(), fixed.end(), [](const Vertex* a, const Vertex* b) { return a->id() < b->id(); });
      for (const Vertex* vertex : fixed) writer.fix(*vertex);
    }
    writer.lines(graph_.fileAttachment().after);
    sink_(text.view());
  }

 private:
  std::vector<Item> collect() const {
    std::vector<Item> items;
    items.reserve(static_cast<std::size_t>(graph_.parameterCount() + graph_.vertexCount() + graph_.edgeCount()));
    graph_.forEachParameter([&](const Parameter& parameter) { items.push_back({.parameter = &parameter}); });
    std::sort(items.begin(), items.end());
    const auto vertices = static_cast<std::ptrdiff_t>(items.size());
    if (vertices_) graph_.forEachVertex([&](const Vertex& vertex) { items.push_back({.vertex = &vertex}); });
    std::sort(items.begin() + vertices, items.end());
    graph_.forEachEdge([&](const Edge& edge) { items.push_back({.edge = &edge}); });
    return items;
  }

  void writeItems(const std::vector<Item>& items) {
    std::vector<NumberWriter> texts(tasksPerWrite);
    std::vector<std::optional<GraphError>> errors(tasksPerWrite);
    for (std::size_t first = 0; first < items.size(); first += itemsPerTask * tasksPerWrite) {
      const std::size_t left = items.size() - first;
      const std::size_t tasks = std::min(tasksPerWrite, (left + itemsPerTask - 1) / itemsPerTask);
      parallelFor(static_cast<std::int64_t>(tasks), threads_, [&](std::int64_t task) {
        const auto t = static_cast<std::size_t>(task);
        const std::size_t begin = first + t * itemsPerTask;
        texts[t].clear();
        ElementWriter writer(graph_, options_, texts[t]);
        try {
          for (std::size_t i = begin; i < std::min(begin + itemsPerTask, items.size()); ++i) writer.write(items[i]);
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

  const Graph& graph_;
  const WriteOptions& options_;
  int threads_;
  /// Whether vertices have lines.
  bool vertices_;
  FunctionRef<void(std::string_view)> sink_;
};

void writeLines(const Graph& graph, const WriteOptions& options, FunctionRef<void(std::string_view)> sink) {
  if (options.format == GraphFormat::bal) return detail::writeBal(graph, options.threads, sink);
  if (options.format != GraphFormat::csv) return G2oWriter(graph, options, sink).run();
  detail::CsvWriter table(*graph.registry(), sink);
  const auto rows = [&](std::string_view lines) { table.write(lines); };
  G2oWriter(graph, options, rows).run();
}

}  // namespace

void writeGraph(const std::string& path, const Graph& graph, const WriteOptions& options) {
  WriteOptions chosen = options;
  chosen.format = options.format.value_or(formatOfPath(path));
  checkFormat(*chosen.format, graph);
  OutputFile file(path);
  const auto sink = [&](std::string_view text) { file.write(text); };
  writeLines(graph, chosen, sink);
  file.commit();
}

void checkFormat(GraphFormat format, const Graph& graph) {
  if (format == GraphFormat::bal) detail::checkBal(graph);
  if (format == GraphFormat::toro) detail::checkToro(graph);
}

void checkFormat(const std::string& path, const Graph& graph) { checkFormat(formatOfPath(path), graph); }

std::string graphText(const Graph& graph, const WriteOptions& options) {
  if (options.format) checkFormat(*options.format, graph);
  std::string result;
  const auto sink = [&](std::string_view text) { result += text; };
  writeLines(graph, options, sink);
  return result;
}

}  // namespace quiver
