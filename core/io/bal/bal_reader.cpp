#include <quiver/core/io/bal/bal_reader.h>

#include <algorithm>
#include <span>

#include <quiver/core/io/bal/bal_content.h>
#include <quiver/core/io/bal/bal_format.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/parallel.h>

namespace quiver::detail {
namespace {

/// Hands numbers that have been read to an element's type. `first` is the index of the first one in the file.
class NumberReader final : public FieldReader {
 public:
  NumberReader(const SourceText& source, std::span<const double> numbers, std::size_t first)
      : source_(source), numbers_(numbers), first_(first) {}

  double real() override {
    if (next_ == numbers_.size()) fail("the type has more numbers than the format");
    return numbers_[next_++];
  }
  std::int64_t integer() override { fail("the type asks for an integer, and the format has none"); }
  std::string_view word() override { fail("the type asks for a word, and the format has none"); }
  void reals(std::span<double> out) override {
    for (double& value : out) value = NumberReader::real();
  }
  bool atEnd() override { return next_ == numbers_.size(); }
  [[noreturn]] void fail(const std::string& message) const override {
    throw source_.error(balNumberPlace(source_, first_ + std::max<std::size_t>(next_, 1) - 1), message);
  }

 private:
  const SourceText& source_;
  std::span<const double> numbers_;
  std::size_t first_;
  std::size_t next_ = 0;
};

void addVertices(const SourceText& source, const VertexType& type, std::int64_t firstId, std::int64_t count,
                 std::span<const double> values, std::size_t firstNumber, Graph& graph) {
  if (count == 0) return;
  graph.reserve(type, count);
  const std::size_t each = values.size() / static_cast<std::size_t>(count);
  for (std::int64_t i = 0; i < count; ++i) {
    Vertex& vertex = graph.addVertex(type, firstId + i);
    const std::size_t first = static_cast<std::size_t>(i) * each;
    NumberReader reader(source, values.subspan(first, each), firstNumber + first);
    type.read(reader, vertex);
    vertex.setHasEstimate(true);
  }
}

}  // namespace

Graph loadBal(const SourceText& source, std::shared_ptr<const Registry> registry, const ReadOptions& options) {
  const BalTypes types(*registry);
  constexpr std::size_t bytesPerThread = std::size_t{1} << 19;
  const auto useful = static_cast<int>(std::min<std::size_t>(1024, source.text.size() / bytesPerThread + 1));
  const BalContent content =
      readBalContent(source, std::min(options.threads > 0 ? options.threads : hardwareThreads(), useful));
  if (options.report) options.report->format = "bal";

  Graph graph(std::move(registry));
  const std::span<const double> values(content.values);
  const auto cameraValues = static_cast<std::size_t>(BalContent::cameraNumbers * content.cameras);
  const std::size_t firstValue = BalContent::headerNumbers + BalContent::observationNumbers * content.cameraOf.size();
  addVertices(source, *types.camera, 0, content.cameras, values.first(cameraValues), firstValue, graph);
  addVertices(source, *types.point, content.cameras, content.points, values.subspan(cameraValues),
              firstValue + cameraValues, graph);
  graph.reserve(*types.observation, static_cast<std::int64_t>(content.cameraOf.size()));
  for (std::size_t i = 0; i < content.cameraOf.size(); ++i) {
    const std::int64_t ids[2] = {content.cameraOf[i], content.cameras + content.pointOf[i]};
    Edge& edge = graph.addEdge(*types.observation, ids);
    NumberReader reader(source, std::span(content.pixels).subspan(2 * i, 2),
                        BalContent::headerNumbers + BalContent::observationNumbers * i + 2);
    types.observation->read(reader, edge);
  }
  return graph;
}

}  // namespace quiver::detail
