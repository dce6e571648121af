#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <map>
#include <new>
#include <stdexcept>
#include <thread>
#include <unordered_set>

#include <fmt/format.h>

#include <quiver/core/io/g2o/g2o_annotations.h>
#include <quiver/core/io/g2o/g2o_loader.h>
#include <quiver/core/io/toro/bearing_range.h>
#include <quiver/core/util/parallel.h>

namespace quiver::detail {
namespace {

constexpr std::size_t chunkSize = std::size_t{1} << 15;
/// Text that a thread takes some tenths of a millisecond for: with less, waking it up costs more than it gains.
constexpr std::size_t bytesPerThread = std::size_t{1} << 17;

int usefulThreads(int asked, std::size_t bytes) {
  const std::size_t useful = std::max<std::size_t>(1, bytes / bytesPerThread);
  return static_cast<int>(std::min(static_cast<std::size_t>(asked > 0 ? asked : hardwareThreads()), useful));
}

/// I11 I12 I22 I33 I13 I23 to the rows of the upper triangle.
void reorderToro(std::vector<double>& triangle) {
  if (triangle.size() != 6) return;
  triangle = {triangle[0], triangle[1], triangle[4], triangle[2], triangle[5], triangle[3]};
}

/// n with n (n + 1) / 2 = entries.
int triangleDimension(std::size_t entries) {
  int n = 0;
  for (std::size_t sum = 0; sum < entries; sum += static_cast<std::size_t>(++n)) continue;
  return n;
}

std::string_view withoutByteOrderMark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

}  // namespace

G2oLoader::G2oLoader(const SourceText& source, std::shared_ptr<const Registry> registry, const ReadOptions& options)
    : source_(source),
      options_(options),
      tags_(*registry),
      threads_(usefulThreads(options.threads, source.text.size())),
      graph_(std::move(registry)),
      chunks_(cutIntoChunks(withoutByteOrderMark(source.text), chunkSize)) {}

Graph G2oLoader::load() {
  try {
    index();
    addVertices();
  } catch (const ParseError& error) {
    checkFieldsBefore(error.line());
    throw;
  }
  addEdgesAndReadFields();
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
    if (error) throw *error;
  }
}

void G2oLoader::addVertices() {
  const Registry& registry = tags_.registry();
  bool anyVertex = false;
  for (G2oChunk& chunk : chunks_) {
    for (G2oLine& line : chunk.lines) {
      if (line.kind > LineKind::blankVertex) continue;
      const std::int64_t id = idsOf(chunk, line).front();
      const auto type = static_cast<std::size_t>(line.entry->type);
      if (line.kind == LineKind::parameter) {
        if (graph_.findParameter(id)) throw duplicate(line, id, "parameter");
        line.element = &graph_.addParameter(*registry.parameterTypes()[type], id);
      } else {
        if (graph_.findVertex(id)) throw duplicate(line, id, "vertex");
        line.element = &graph_.addVertex(*registry.vertexTypes()[type], id);
        anyVertex = true;
      }
    }
  }
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
      const auto ids = idsOf(chunk, line);
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

void G2oLoader::addEdges(G2oChunk& chunk) {
  const Registry& registry = tags_.registry();
  for (G2oLine& line : chunk.lines) {
    if (line.kind != LineKind::edge) continue;
    const auto ids = idsOf(chunk, line);
    const std::size_t vertices = ids.size() - static_cast<std::size_t>(line.entry->parameters);
    try {
      line.element = &graph_.addEdge(*registry.edgeTypes()[static_cast<std::size_t>(line.entry->type)],
                                     ids.first(vertices), ids.subspan(vertices));
    } catch (const GraphError& error) {
      throw edgeError(line, ids, error.what());
    }
  }
}

/// Edges are added one after the other, in the order of the file, by the first task; the others read the fields of
/// chunks whose edges are there. Tasks are taken in order, so whoever waits waits for a task that has begun.
void G2oLoader::addEdgesAndReadFields() {
  std::vector<FieldPass> passes(chunks_.size());
  std::optional<ParseError> refused;
  std::exception_ptr failure;
  std::atomic<std::size_t> ready{0};
  const auto addAll = [&] {
    try {
      for (G2oChunk& chunk : chunks_) {
        addEdges(chunk);
        ready.fetch_add(1, std::memory_order_release);
      }
    } catch (const ParseError& error) {
      refused = error;
    } catch (...) {
      failure = std::current_exception();
    }
    ready.store(chunks_.size(), std::memory_order_release);
  };
  const auto count = static_cast<std::int64_t>(chunks_.size());
  parallelFor(count + 1, threads_, [&](std::int64_t task) {
    if (task == 0) return addAll();
    const auto k = static_cast<std::size_t>(task - 1);
    while (ready.load(std::memory_order_acquire) <= k) std::this_thread::yield();
    readFields(k, passes[k]);
  });
  if (failure) std::rethrow_exception(failure);
  if (refused) {
    checkFieldsBefore(refused->line());
    throw *refused;
  }
  report(passes);
}

ParseError G2oLoader::duplicate(const G2oLine& line, std::int64_t id, const char* what) const {
  const bool parameter = line.kind == LineKind::parameter;
  std::int64_t first = 0;
  for (const G2oChunk& chunk : chunks_) {
    for (const G2oLine& other : chunk.lines) {
      const bool alike = parameter ? other.kind == LineKind::parameter
                                   : other.kind == LineKind::vertex || other.kind == LineKind::blankVertex;
      if (first == 0 && alike && idsOf(chunk, other).front() == id) first = source_.lineOf(other.begin);
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

void G2oLoader::readFields(std::size_t chunk, FieldPass& pass) const {
  try {
    for (const G2oLine& line : chunks_[chunk].lines) {
      if (line.element) readElement(line, line.element, pass);
    }
  } catch (const ParseError& error) {
    pass.error = error;
  }
}

void G2oLoader::report(const std::vector<FieldPass>& passes) const {
  for (const FieldPass& pass : passes) {
    if (pass.error) throw *pass.error;
  }
  refuseInformation(passes);
  if (options_.report) {
    for (const FieldPass& pass : passes) options_.report->clampedInformation += pass.clamped;
  }
}

void G2oLoader::readElement(const G2oLine& line, void* element, FieldPass& pass) const {
  const Registry& registry = tags_.registry();
  const auto index = static_cast<std::size_t>(line.entry->type);
  G2oFieldReader reader(source_, tags_.elementType(*line.entry), line.begin, line.fields);
  try {
    if (line.kind == LineKind::parameter) {
      registry.parameterTypes()[index]->read(reader, *static_cast<Parameter*>(element));
    } else if (line.kind == LineKind::vertex) {
      Vertex& vertex = *static_cast<Vertex*>(element);
      registry.vertexTypes()[index]->read(reader, vertex);
      vertex.setHasEstimate(true);
    } else if (line.kind == LineKind::edge && line.entry->dialect == LineDialect::bearingRange) {
      readBearingRange(*registry.edgeTypes()[index], reader, *static_cast<Edge*>(element));
    } else if (line.kind == LineKind::edge) {
      const EdgeType& type = *registry.edgeTypes()[index];
      Edge& edge = *static_cast<Edge*>(element);
      if (type.errorDimension() == Dynamic) refuseHopeless(line);
      type.read(reader, edge);
      if (type.hasInformationField()) {
        readInformation(type, edge, line.entry->dialect == LineDialect::toro, reader, pass);
      } else {
        const std::span<const double> made = type.information(edge);
        pass.triangle.assign(made.begin(), made.end());
        checkInformation(type, edge, line.fields, pass);
      }
      type.readTail(reader, edge);
    }
  } catch (const ParseError&) {
    throw;
  } catch (const Error& error) {
    reader.fail(error.what());
  } catch (const std::bad_alloc&) {
    reader.fail("this needs more memory than there is");
  } catch (const std::length_error&) {
    reader.fail("this needs more memory than there is");
  }
  reader.expectEnd();
}

/// An edge over very many vertices asks for an information matrix of that many rows at least: a line too short for it
/// is refused before its type reserves memory for the square of a number that anybody can write.
void G2oLoader::refuseHopeless(const G2oLine& line) const {
  constexpr std::size_t many = 1000;
  const std::size_t vertices = line.idCount;
  if (vertices <= many) return;
  TextScanner rest(std::string_view(line.fields, static_cast<std::size_t>(source_.end() - line.fields)));
  if (rest.nextLine().size() / vertices < vertices) {
    throw source_.endsEarly(line.fields, fmt::format("the information matrix for {} vertices is missing", vertices));
  }
}

void G2oLoader::readInformation(const EdgeType& type, Edge& edge, bool toro, G2oFieldReader& reader,
                                FieldPass& pass) const {
  const int fixed = type.errorDimension();
  reader.information(fixed != Dynamic ? fixed : type.errorDimension(edge), pass.triangle);
  if (toro) reorderToro(pass.triangle);
  checkInformation(type, edge, reader.informationPlace(), pass);
}

void G2oLoader::checkInformation(const EdgeType& type, Edge& edge, const char* place, FieldPass& pass) const {
  const int dimension = triangleDimension(pass.triangle.size());
  if (!pass.check.accepts(pass.triangle, dimension)) {
    if (options_.information == InformationPolicy::clamp) {
      clampInformation(pass.triangle, dimension);
      ++pass.clamped;
    } else if (pass.refused++ == 0) {
      pass.firstRefused = place;
      pass.firstRange = eigenvalueRange(pass.triangle, dimension);
    }
  }
  type.setInformation(edge, pass.triangle);
}

void G2oLoader::refuseInformation(const std::vector<FieldPass>& passes) const {
  std::int64_t count = 0;
  const FieldPass* first = nullptr;
  for (const FieldPass& pass : passes) {
    if (pass.refused > 0 && !first) first = &pass;
    count += pass.refused;
  }
  if (!first) return;
  throw source_.error(
      first->firstRefused,
      fmt::format("information matrix is not positive semi-definite: its eigenvalues reach from {:.6g} to {:.6g} ({})",
                  first->firstRange.least, first->firstRange.most,
                  count == 1 ? "the only such line" : fmt::format("the first of {} such lines", count)));
}

void G2oLoader::checkFieldsBefore(std::int64_t line) const {
  FieldPass pass;
  const Registry& registry = tags_.registry();
  std::map<const TagEntry*, std::shared_ptr<void>> pools;
  const auto readScratch = [&]<typename Base>(const G2oLine& entry, const auto& types, Base*) {
    std::shared_ptr<void>& pool = pools[entry.entry];
    if (!pool)
      pool = std::shared_ptr<ElementPool<Base>>(types[static_cast<std::size_t>(entry.entry->type)]->makePool());
    auto& typed = *static_cast<ElementPool<Base>*>(pool.get());
    const std::int64_t slot = typed.add();
    readElement(entry, &typed.at(slot), pass);
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
