#include <algorithm>
#include <map>
#include <unordered_set>

#include <fmt/format.h>

#include <quiver/core/io/g2o/g2o_annotations.h>
#include <quiver/core/io/g2o/g2o_loader.h>
#include <quiver/core/util/parallel.h>

namespace quiver::detail {
namespace {

/// Small chunks share the work of small files evenly; the elements of a chunk fit into the cache.
constexpr std::size_t leastChunk = std::size_t{1} << 14;
constexpr std::size_t largestChunk = std::size_t{1} << 18;
constexpr std::size_t fewChunks = 48;

std::size_t chunkSize(std::size_t bytes) { return std::clamp(bytes / fewChunks, leastChunk, largestChunk); }

/// Text that a thread takes some tenths of a millisecond for: with less, waking it up costs more than it gains.
constexpr std::size_t bytesPerThread = std::size_t{1} << 17;

int usefulThreads(int asked, std::size_t bytes) {
  const std::size_t useful = std::max<std::size_t>(1, bytes / bytesPerThread);
  return static_cast<int>(std::min(static_cast<std::size_t>(asked > 0 ? asked : hardwareThreads()), useful));
}

/// An empty loop: threads that sleep take as long to wake up as what comes before the first loop.
int awakened(int threads) {
  parallelFor(threads, threads, [](std::int64_t) {});
  return threads;
}

std::string_view withoutByteOrderMark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

}  // namespace

G2oLoader::G2oLoader(const SourceText& source, std::shared_ptr<const Registry> registry, const ReadOptions& options)
    : source_(source),
      options_(options),
      threads_(awakened(usefulThreads(options.threads, source.text.size()))),
      tags_(*registry),
      graph_(std::move(registry)),
      chunks_(cutIntoChunks(withoutByteOrderMark(source.text), chunkSize(source.text.size()))) {}

Graph G2oLoader::load() {
  index();
  addElements();
  G2oAnnotations annotations(source_, options_, graph_);
  for (const G2oChunk& chunk : chunks_) annotations.apply(chunk);
  annotations.finish();
  if (options_.report && isToro()) options_.report->format = "toro";
  if (graph_.vertexCount() == 0 && graph_.edgeCount() == 0) {
    throw ParseError(source_.name, 0, 0, "the file holds no vertex and no edge");
  }
  return std::move(graph_);
}

/// Whether every vertex and edge is one of TORO's. Landmarks have no line of their own there, or g2o's.
bool G2oLoader::isToro() const {
  bool toro = false;
  const TagEntry* const landmark = tags_.find("VERTEX_XY");
  for (const G2oChunk& chunk : chunks_) {
    for (const G2oLine& line : chunk.lines) {
      if (line.kind > LineKind::edge || line.entry == landmark) continue;
      if (!line.entry->toro) return false;
      toro = true;
    }
  }
  return toro;
}

void G2oLoader::index() {
  std::vector<std::optional<ParseError>> errors(chunks_.size());
  parallelFor(static_cast<std::int64_t>(chunks_.size()), threads_, [&](std::int64_t i) {
    const auto k = static_cast<std::size_t>(i);
    try {
      G2oIndexer(source_, tags_, options_.unknown == UnknownTags::error, chunks_[k]).run();
    } catch (const ParseError& error) {
      errors[k] = error;
    }
  });
  for (const auto& error : errors) {
    if (!error) continue;
    checkFieldsBefore(error->line());
    throw *error;
  }
}

void G2oLoader::nameVertices(BulkAdder& adder) {
  const Registry& registry = tags_.registry();
  const auto refuse = [&](const G2oLine& line, std::int64_t id, const char* what) {
    const ParseError error = duplicate(line, id, what);
    checkFieldsBefore(error.line());
    throw error;
  };
  bool anyVertex = false;
  for (G2oChunk& chunk : chunks_) {
    for (G2oLine& line : chunk.lines) {
      if (line.kind > LineKind::blankVertex) continue;
      const std::int64_t id = chunk.idsOf(line).front();
      if (line.kind == LineKind::parameter) {
        if (graph_.findParameter(id)) refuse(line, id, "parameter");
        line.element = &graph_.addParameter(*registry.parameterTypes()[static_cast<std::size_t>(line.entry->type)], id);
      } else {
        if (!adder.nameVertex(line.entry->type, id)) refuse(line, id, "vertex");
        anyVertex = true;
      }
    }
  }
  adder.open();
  addVerticesOfEdges(!anyVertex);
}

/// TORO files have no lines for landmarks.
void G2oLoader::addVerticesOfEdges(bool allEdges) {
  const Registry& registry = tags_.registry();
  for (const G2oChunk& chunk : chunks_) {
    for (const G2oLine& line : chunk.lines) {
      const bool landmark = line.kind == LineKind::edge && line.entry->dialect == LineDialect::bearingRange;
      if (line.kind != LineKind::edge || !(allEdges || landmark)) continue;
      const EdgeType& type = *registry.edgeTypes()[static_cast<std::size_t>(line.entry->type)];
      const auto ids = chunk.idsOf(line);
      const int count = static_cast<int>(ids.size()) - line.entry->parameters;
      for (int role = allEdges ? 0 : 1; role < count; ++role) {
        const std::int64_t id = ids[static_cast<std::size_t>(role)];
        if (graph_.findVertex(id)) continue;
        if (const VertexType* vertex = registry.findVertexTypeByName(type.vertexTypeName(role)))
          graph_.addVertex(*vertex, id);
      }
    }
  }
}

void G2oLoader::addElements() {
  std::vector<ElementCounts> counts;
  counts.reserve(chunks_.size());
  for (G2oChunk& chunk : chunks_) counts.push_back(std::move(chunk.counts));
  BulkAdder adder(graph_, std::move(counts));
  nameVertices(adder);
  std::vector<ChunkResult> results(chunks_.size());
  parallelFor(static_cast<std::int64_t>(chunks_.size()), threads_, [&](std::int64_t i) {
    const auto k = static_cast<std::size_t>(i);
    try {
      fillChunk(k, adder, results[k]);
    } catch (const ParseError& error) {
      results[k].error = error;
    } catch (...) {
      results[k].failure = std::current_exception();
    }
  });
  report(results);
  adder.finish();
}

void G2oLoader::fillChunk(std::size_t chunk, BulkAdder& adder, ChunkResult& result) {
  adder.begin(chunk);
  G2oElementReader reader(source_, tags_, options_);
  for (G2oLine& line : chunks_[chunk].lines) {
    if (line.kind > LineKind::edge) continue;
    const auto ids = chunks_[chunk].idsOf(line);
    if (line.kind == LineKind::edge) {
      const std::size_t vertices = ids.size() - static_cast<std::size_t>(line.entry->parameters);
      try {
        line.element = &adder.addEdge(chunk, line.entry->type, ids.first(vertices), ids.subspan(vertices));
      } catch (const GraphError& error) {
        result.refusedEdge = &line;
        result.refusal = error.what();
        return;
      }
    } else if (line.kind != LineKind::parameter) {
      line.element = &adder.addVertex(chunk, line.entry->type, ids.front());
    }
    reader.read(line, line.element);
  }
  result.faults = reader.faults();
}

void G2oLoader::report(const std::vector<ChunkResult>& results) const {
  for (std::size_t k = 0; k < results.size(); ++k) {
    const ChunkResult& result = results[k];
    if (result.refusedEdge) throw edgeError(*result.refusedEdge, chunks_[k].idsOf(*result.refusedEdge), result.refusal);
    if (result.error) throw *result.error;
    if (result.failure) std::rethrow_exception(result.failure);
  }
  refuseInformation(results);
  if (options_.report) {
    for (const ChunkResult& result : results) options_.report->clampedInformation += result.faults.clamped;
  }
}

ParseError G2oLoader::duplicate(const G2oLine& line, std::int64_t id, const char* what) const {
  const bool parameter = line.kind == LineKind::parameter;
  std::int64_t first = 0;
  for (const G2oChunk& chunk : chunks_) {
    for (const G2oLine& other : chunk.lines) {
      const bool alike = parameter ? other.kind == LineKind::parameter
                                   : other.kind == LineKind::vertex || other.kind == LineKind::blankVertex;
      if (first == 0 && alike && chunk.idsOf(other).front() == id) first = source_.lineOf(other.begin);
    }
  }
  const int idToken = line.kind == LineKind::blankVertex ? 3 : 1;
  return source_.error(source_.tokenPlace(line.begin, idToken),
                       fmt::format("{} {} exists already, since line {}", what, id, first));
}

/// Points at the id that the graph complains about; the graph's own words serve where the file adds nothing to them.
ParseError G2oLoader::edgeError(const G2oLine& line, std::span<const std::int64_t> ids,
                                const std::string& message) const {
  const EdgeType& type = *graph_.registry()->edgeTypes()[static_cast<std::size_t>(line.entry->type)];
  const std::size_t vertices = ids.size() - static_cast<std::size_t>(line.entry->parameters);
  const std::string_view tag = source_.tokenAt(line.begin);
  const auto at = [&](std::size_t i, const std::string& text) {
    const bool afterBars = i >= vertices && line.entry->variableArity;
    return source_.error(source_.tokenPlace(line.begin, static_cast<int>(i) + (afterBars ? 2 : 1)), text);
  };
  std::unordered_set<std::int64_t> seen;
  for (std::size_t i = 0; i < vertices; ++i) {
    const Vertex* vertex = graph_.findVertex(ids[i]);
    if (!vertex) return at(i, fmt::format("{} names vertex {}, which is not in the file", tag, ids[i]));
    if (!seen.insert(ids[i]).second) return at(i, fmt::format("{} names vertex {} twice", tag, ids[i]));
    if (graph_.typeOf(*vertex).cppName() != type.vertexTypeName(static_cast<int>(i))) return at(i, message);
  }
  const std::vector<std::string_view> wanted = type.parameterTypeNames();
  for (std::size_t i = vertices; i < ids.size(); ++i) {
    const Parameter* parameter = graph_.findParameter(ids[i]);
    if (!parameter) return at(i, fmt::format("{} names parameter {}, which is not in the file", tag, ids[i]));
    if (graph_.typeOf(*parameter).cppName() != wanted[i - vertices]) return at(i, message);
  }
  return source_.error(line.begin, message);
}

void G2oLoader::refuseInformation(const std::vector<ChunkResult>& results) const {
  std::int64_t count = 0;
  const InformationFaults* first = nullptr;
  for (const ChunkResult& result : results) {
    if (result.faults.refused > 0 && !first) first = &result.faults;
    count += result.faults.refused;
  }
  if (!first) return;
  throw source_.error(
      first->firstRefused,
      fmt::format("information matrix is not positive semi-definite: its eigenvalues reach from {:.6g} to {:.6g} ({})",
                  first->firstRange.least, first->firstRange.most,
                  count == 1 ? "the only such line" : fmt::format("the first of {} such lines", count)));
}

void G2oLoader::checkFieldsBefore(std::int64_t line) const {
  G2oElementReader reader(source_, tags_, options_);
  const Registry& registry = tags_.registry();
  std::map<const TagEntry*, std::shared_ptr<void>> pools;
  const auto readScratch = [&]<typename Base>(const G2oLine& entry, const auto& types, Base*) {
    std::shared_ptr<void>& pool = pools[entry.entry];
    if (!pool)
      pool = std::shared_ptr<ElementPool<Base>>(types[static_cast<std::size_t>(entry.entry->type)]->makePool());
    auto& typed = *static_cast<ElementPool<Base>*>(pool.get());
    const auto [element, slot] = typed.add();
    reader.read(entry, &element);
    typed.remove(slot);
  };
  const char* const stop = source_.linePlace(line);
  for (const G2oChunk& chunk : chunks_) {
    for (const G2oLine& entry : chunk.lines) {
      if (entry.begin >= stop) return;
      if (entry.kind == LineKind::parameter)
        readScratch(entry, registry.parameterTypes(), static_cast<Parameter*>(nullptr));
      if (entry.kind == LineKind::vertex) readScratch(entry, registry.vertexTypes(), static_cast<Vertex*>(nullptr));
      if (entry.kind == LineKind::edge) readScratch(entry, registry.edgeTypes(), static_cast<Edge*>(nullptr));
    }
  }
}

}  // namespace quiver::detail
