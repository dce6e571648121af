#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include <quiver/core/io/g2o/g2o_annotations.h>

namespace quiver::detail {

void G2oAnnotations::apply(const G2oChunk& chunk) {
  for (const G2oLine& line : chunk.lines) {
    switch (line.kind) {
      case LineKind::parameter:
      case LineKind::vertex:
      case LineKind::blankVertex:
      case LineKind::edge:
        takeElement(line);
        break;
      case LineKind::fix:
        fix(chunk, line);
        break;
      case LineKind::comment:
        comments_.push_back(textOf(line));
        break;
      case LineKind::data:
        keep(line);
        break;
      case LineKind::directive:
        directive(line);
        break;
      case LineKind::unknown:
        unknown(line, source_.tokenAt(line.begin));
        break;
    }
  }
}

void G2oAnnotations::finish() {
  std::vector<std::string>& rest = last_ ? graph_.fileAttachment().after : graph_.fileAttachment().before;
  rest.insert(rest.end(), std::make_move_iterator(comments_.begin()), std::make_move_iterator(comments_.end()));
  comments_.clear();
}

/// Comments above the first element are taken for the file's own: they stay at the top whatever is sorted below.
void G2oAnnotations::takeElement(const G2oLine& line) {
  if (!comments_.empty()) {
    std::vector<std::string>& before = last_ ? attachmentOf(line).before : graph_.fileAttachment().before;
    before.insert(before.end(), std::make_move_iterator(comments_.begin()), std::make_move_iterator(comments_.end()));
    comments_.clear();
  }
  last_ = &line;
}

void G2oAnnotations::fix(const G2oChunk& chunk, const G2oLine& line) {
  for (std::uint32_t i = 0; i < line.idCount; ++i) {
    const std::int64_t id = chunk.ids[line.firstId + i];
    Vertex* vertex = graph_.findVertex(id);
    if (!vertex) {
      throw source_.error(source_.tokenPlace(line.begin, static_cast<int>(i) + 1),
                          fmt::format("FIX names vertex {}, which is not in the file", id));
    }
    vertex->setFixed(true);
  }
}

/// Keeps a line as text behind the element before it, and the comments in between in their place.
void G2oAnnotations::keep(const G2oLine& line) {
  std::vector<std::string>& lines = last_ ? attachmentOf(*last_).after : graph_.fileAttachment().before;
  lines.insert(lines.end(), std::make_move_iterator(comments_.begin()), std::make_move_iterator(comments_.end()));
  comments_.clear();
  lines.push_back(textOf(line));
}

void G2oAnnotations::unknown(const G2oLine& line, std::string_view tag) {
  if (options_.unknown == UnknownTags::keep) {
    // At the top of a file these would make it one of another format.
    double number = 0.0;
    if (tag.find_first_of(",\"") != std::string_view::npos || TextScanner(tag).real(number) == NumberStatus::ok)
      throw source_.error(line.begin, fmt::format("unknown tag {}, which is none that can be kept", quoted(tag)));
    keep(line);
  }
  if (!options_.report) return;
  auto& list = options_.report->unknownTags;
  const auto [it, isNew] = unknownTags_.emplace(tag, list.size());
  if (isNew) list.emplace_back(tag, 0);
  ++list[it->second].second;
}

void G2oAnnotations::directive(const G2oLine& line) {
  TextScanner scanner(std::string_view(line.begin, static_cast<std::size_t>(source_.end() - line.begin)));
  scanner.token();
  if (scanner.atLineEnd())
    throw source_.endsEarly(line.begin, "'#quiver' is followed by kernel, level, fixed or vertex");
  const std::string_view word = scanner.token();
  if (word == "kernel") {
    setKernel(scanner);
  } else if (word == "level") {
    setLevel(scanner);
  } else if (word == "fixed") {
    setFixedDirections(scanner);
  } else if (options_.unknown == UnknownTags::error) {
    throw source_.error(
        word.data(), fmt::format("unknown #quiver line {}: known are kernel, level, fixed and vertex", quoted(word)));
  } else {
    return unknown(line, "#quiver");
  }
  expectEnd(scanner);
}

void G2oAnnotations::setKernel(TextScanner& scanner) {
  const char* const line = scanner.cursor();
  if (scanner.atLineEnd()) throw source_.endsEarly(line, "the kernel's name is missing");
  const std::string_view name = scanner.token();
  Edge& edge = edgeBefore(name.data(), "kernel");
  const RobustKernelType* type = graph_.registry()->findRobustKernel(name);
  if (!type) {
    std::vector<std::string> known;
    for (const RobustKernelType* kernel : graph_.registry()->robustKernels()) known.emplace_back(kernel->name);
    const std::string nearest = nearestWord(name, known);
    throw source_.error(name.data(), fmt::format("unknown robust kernel {}{}", quoted(name),
                                                 nearest.empty() ? "" : fmt::format(", did you mean '{}'?", nearest)));
  }
  scanner.atLineEnd();
  const char* const place = scanner.cursor();
  const double width = number(scanner, "the kernel's width is missing");
  if (!(width > 0.0)) throw source_.error(place, "a kernel's width is positive");
  const double shape = scanner.atLineEnd() ? type->defaultShape : number(scanner, "");
  edge.setRobustKernel(RobustKernel(*type, width, shape));
}

void G2oAnnotations::setLevel(TextScanner& scanner) {
  Edge& edge = edgeBefore(scanner.cursor(), "level");
  edge.setLevel(
      static_cast<int>(integer(scanner, std::numeric_limits<int>::min(), std::numeric_limits<int>::max(), "a level")));
}

void G2oAnnotations::setFixedDirections(TextScanner& scanner) {
  if (!last_ || (last_->kind != LineKind::vertex && last_->kind != LineKind::blankVertex)) {
    throw source_.error(scanner.cursor(), "'#quiver fixed' stands after a vertex");
  }
  Vertex& vertex = *static_cast<Vertex*>(last_->element);
  const int dimension = graph_.typeOf(vertex).dimension(vertex);
  // A vector of run-time size may have no size yet.
  const std::int64_t most = dimension > 0 ? std::min(dimension, 64) - 1 : 63;
  std::uint64_t mask = 0;
  do {
    mask |= std::uint64_t{1} << integer(scanner, 0, most, "a direction of this vertex");
  } while (!scanner.atLineEnd());
  vertex.setFixedDirections(mask);
}

Edge& G2oAnnotations::edgeBefore(const char* place, const char* what) {
  if (!last_ || last_->kind != LineKind::edge)
    throw source_.error(place, fmt::format("'#quiver {}' stands after an edge", what));
  return *static_cast<Edge*>(last_->element);
}

double G2oAnnotations::number(TextScanner& scanner, const char* whatIsMissing) {
  if (scanner.atLineEnd()) throw source_.endsEarly(scanner.cursor(), whatIsMissing);
  const char* const place = scanner.cursor();
  double value = 0.0;
  const NumberStatus status = scanner.real(value);
  if (status != NumberStatus::ok) throw source_.badNumber(place, status, false);
  return value;
}

std::int64_t G2oAnnotations::integer(TextScanner& scanner, std::int64_t least, std::int64_t most, const char* what) {
  if (scanner.atLineEnd()) throw source_.endsEarly(scanner.cursor(), fmt::format("{} is missing", what));
  const char* const place = scanner.cursor();
  std::int64_t value = 0;
  const NumberStatus status = scanner.integer(value);
  if (status != NumberStatus::ok) throw source_.badNumber(place, status, true);
  if (value < least || value > most)
    throw source_.error(place, fmt::format("{} is a number from {} to {}", what, least, most));
  return value;
}

void G2oAnnotations::expectEnd(TextScanner& scanner) {
  if (scanner.atLineEnd()) return;
  const std::string_view extra = scanner.token();
  throw source_.error(extra.data(), fmt::format("unexpected {} at the end of a #quiver line", quoted(extra)));
}

Attachment& G2oAnnotations::attachmentOf(const G2oLine& line) {
  if (line.kind == LineKind::parameter) return graph_.attachment(*static_cast<Parameter*>(line.element));
  if (line.kind == LineKind::edge) return graph_.attachment(*static_cast<Edge*>(line.element));
  return graph_.attachment(*static_cast<Vertex*>(line.element));
}

std::string G2oAnnotations::textOf(const G2oLine& line) const {
  TextScanner scanner(std::string_view(line.begin, static_cast<std::size_t>(source_.end() - line.begin)));
  std::string_view text = scanner.nextLine();
  text = text.substr(0, text.find_last_not_of(" \t\r") + 1);
  return std::string(text);
}

}  // namespace quiver::detail
