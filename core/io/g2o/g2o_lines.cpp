#include <algorithm>

#include <fmt/format.h>

#include <quiver/core/io/g2o/g2o_lines.h>

namespace quiver::detail {

TagTable::TagTable(const Registry& registry) : registry_(registry) {
  // One piece of memory: nodes of their own cost a tenth of the time of a small file.
  entries_.reserve(registry.vertexTypes().size() + registry.parameterTypes().size() + registry.edgeTypes().size() +
                   registry.aliases().size() + registry.dataTags().size() + 4);
  add("FIX", TagEntry{.kind = LineKind::fix});
  for (const auto& type : registry.vertexTypes()) {
    add(type->tag(), TagEntry{.kind = LineKind::vertex, .type = type->index()});
  }
  for (const auto& type : registry.parameterTypes()) {
    add(type->tag(), TagEntry{.kind = LineKind::parameter, .type = type->index()});
  }
  for (const auto& type : registry.edgeTypes()) {
    add(type->tag(), TagEntry{.kind = LineKind::edge,
                              .type = type->index(),
                              .arity = type->arity(),
                              .variableArity = type->variableArity(),
                              .parameters = static_cast<int>(type->parameterTypeNames().size()),
                              .informationInLine = type->hasInformationField()});
  }
  for (const auto& [alias, tag] : registry.aliases()) {
    if (const TagEntry* entry = find(tag)) add(alias, *entry);
  }
  for (const auto& data : registry.dataTags()) add(data.name, TagEntry{.kind = LineKind::data});
  addToroTag("VERTEX2", "VERTEX_SE2", LineDialect::toro);
  addToroTag("EDGE2", "EDGE_SE2", LineDialect::toro);
  addToroTag("BR", "EDGE_SE2_XY", LineDialect::bearingRange);
  for (const std::string_view tag : {"VERTEX3", "EDGE3"}) {
    for (auto& [known, entry] : entries_) entry.toro = entry.toro || known == tag;
  }
}

/// Unless the registry has a type of that tag, or none that the tag could stand for.
void TagTable::addToroTag(std::string_view tag, std::string_view g2oTag, LineDialect dialect) {
  const TagEntry* known = find(g2oTag);
  if (!known) return;
  TagEntry entry = *known;
  entry.dialect = dialect;
  entry.toro = true;
  add(tag, entry);
}

void TagTable::add(std::string_view tag, const TagEntry& entry) {
  const auto place = std::ranges::lower_bound(entries_, tag, {}, &std::pair<std::string_view, TagEntry>::first);
  if (place == entries_.end() || place->first != tag) entries_.insert(place, {tag, entry});
}

const TagEntry* TagTable::find(std::string_view tag) const {
  const auto place = std::ranges::lower_bound(entries_, tag, {}, &std::pair<std::string_view, TagEntry>::first);
  return place == entries_.end() || place->first != tag ? nullptr : &place->second;
}

const ElementType& TagTable::elementType(const TagEntry& entry) const {
  const auto index = static_cast<std::size_t>(entry.type);
  if (entry.kind == LineKind::vertex) return *registry_.vertexTypes()[index];
  if (entry.kind == LineKind::edge) return *registry_.edgeTypes()[index];
  return *registry_.parameterTypes()[index];
}

std::vector<G2oChunk> cutIntoChunks(std::string_view text, std::size_t size) {
  std::vector<G2oChunk> chunks;
  while (!text.empty()) {
    std::size_t end = text.size() <= size ? std::string_view::npos : text.find('\n', size);
    end = end == std::string_view::npos ? text.size() : end + 1;
    chunks.emplace_back().text = text.substr(0, end);
    text.remove_prefix(end);
  }
  return chunks;
}

void G2oIndexer::run() {
  constexpr std::size_t shortLine = 48;  // room for lines of such a length, as planar files have them
  chunk_.counts = ElementCounts(tags_.registry());
  chunk_.lines.reserve(chunk_.text.size() / shortLine + 1);
  chunk_.ids.reserve(2 * (chunk_.text.size() / shortLine + 1));
  while (!scanner_.atEnd()) {
    if (!scanner_.atLineEnd()) readLine();
    scanner_.nextLine();
  }
}

/// Nearly always the tag of the line before, which one comparison tells.
std::string_view G2oIndexer::readTag() { return scanner_.skipToken(lastTag_) ? lastTag_ : scanner_.token(); }

void G2oIndexer::count(const G2oLine& line) {
  if (line.kind == LineKind::vertex || line.kind == LineKind::blankVertex)
    ++chunk_.counts.vertices[static_cast<std::size_t>(line.entry->type)];
  if (line.kind == LineKind::edge) ++chunk_.counts.edges[static_cast<std::size_t>(line.entry->type)];
}

void G2oIndexer::readLine() {
  G2oLine line;
  line.begin = scanner_.cursor();
  line.firstId = static_cast<std::uint32_t>(chunk_.ids.size());
  const std::string_view tag = readTag();
  if (tag.front() == '#') {
    readHash(tag, line);
  } else {
    line.entry = lookUp(tag);
    if (!line.entry && refuseUnknown_) refuseTag(tag);
    line.kind = line.entry ? line.entry->kind : LineKind::unknown;
  }
  switch (line.kind) {
    case LineKind::vertex:
    case LineKind::blankVertex:
      readId("vertex", [&] { return fmt::format("the id of {} is missing", quoted(tag)); });
      break;
    case LineKind::parameter:
      readId("parameter", [&] { return fmt::format("the id of {} is missing", quoted(tag)); });
      break;
    case LineKind::edge:
      readEdgeIds(*line.entry, tag);
      break;
    case LineKind::fix:
      readFixIds();
      break;
    default:
      refuseBinary(line.begin);
      break;
  }
  line.idCount = static_cast<std::uint32_t>(chunk_.ids.size()) - line.firstId;
  if (line.kind <= LineKind::edge) line.fields = scanner_.cursor();
  count(line);
  chunk_.lines.push_back(line);
}

/// Comments are kept as they are, up to their bytes; "#quiver vertex" makes a vertex and so is read with the vertices.
void G2oIndexer::readHash(std::string_view word, G2oLine& line) {
  line.kind = LineKind::comment;
  if (word == "#quiver") {
    line.kind = LineKind::directive;
    TextScanner peek = scanner_;
    if (peek.token() == "vertex") {
      peek.atLineEnd();
      const char* place = peek.cursor();
      const std::string_view tag = peek.token();
      line.entry = lookUp(tag);
      if (tag.empty()) throw source_.endsEarly(place, "'#quiver vertex' is followed by a tag and an id");
      if (!line.entry || line.entry->kind != LineKind::vertex) {
        throw source_.error(place, fmt::format("{} is no vertex type", quoted(tag)));
      }
      line.kind = LineKind::blankVertex;
      scanner_ = peek;
    }
  }
}

const TagEntry* G2oIndexer::lookUp(std::string_view tag) {
  if (tag.data() != lastTag_.data() && tag != lastTag_) {
    lastEntry_ = tags_.find(tag);
    lastTag_ = tag;
  }
  return lastEntry_;
}

/// Lines that are kept as text are the only ones whose bytes nothing else looks at.
void G2oIndexer::refuseBinary(const char* begin) {
  TextScanner rest(std::string_view(begin, static_cast<std::size_t>(source_.end() - begin)));
  if (const char* binary = findBinary(rest.nextLine())) throw source_.error(binary, "binary data");
}

template <typename Describe>
void G2oIndexer::readId(const char* what, Describe missing) {
  if (scanner_.atLineEnd()) throw source_.endsEarly(scanner_.cursor(), missing());
  const char* const place = scanner_.cursor();
  std::int64_t id = 0;
  const NumberStatus status = scanner_.integer(id);
  if (status != NumberStatus::ok) throw source_.badNumber(place, status, true);
  if (id < 0) throw source_.error(place, fmt::format("{} id {} is negative; ids are 0 or more", what, id));
  chunk_.ids.push_back(id);
}

void G2oIndexer::readEdgeIds(const TagEntry& entry, std::string_view tag) {
  const auto tooFew = [&] {
    return fmt::format("{} joins {}{} {}", tag, entry.variableArity ? "at least " : "", entry.arity,
                       entry.arity == 1 ? "vertex" : "vertices");
  };
  for (int i = 0; i < entry.arity; ++i) readId("vertex", tooFew);
  if (entry.variableArity) {
    for (;;) {
      if (scanner_.atLineEnd()) {
        throw source_.endsEarly(scanner_.cursor(), fmt::format("'||' ends the vertices of {}", tag));
      }
      TextScanner peek = scanner_;
      if (peek.token() == "||") {
        scanner_ = peek;
        break;
      }
      readId("vertex", tooFew);
    }
  }
  for (int i = 0; i < entry.parameters; ++i) {
    readId("parameter", [&] {
      return fmt::format("{} names {} parameter{}", tag, entry.parameters, entry.parameters == 1 ? "" : "s");
    });
  }
}

void G2oIndexer::readFixIds() {
  do {
    readId("vertex", [] { return std::string("FIX names at least one vertex"); });
  } while (!scanner_.atLineEnd());
}

void G2oIndexer::refuseTag(std::string_view tag) const {
  std::vector<std::string> known = tags_.registry().knownTags();
  for (const char* toro : {"VERTEX2", "EDGE2"}) {
    if (tags_.find(toro)) known.emplace_back(toro);
  }
  const std::string nearest = nearestWord(tag, known);
  throw source_.error(tag.data(), nearest.empty()
                                      ? fmt::format("unknown tag {}", quoted(tag))
                                      : fmt::format("unknown tag {}, did you mean '{}'?", quoted(tag), nearest));
}

}  // namespace quiver::detail
