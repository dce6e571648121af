#include <quiver/core/io/csv/csv_text.h>

#include <algorithm>

#include <quiver/core/io/text/text_scanner.h>

namespace quiver::detail {
namespace {

constexpr std::string_view byteOrderMark = "\xef\xbb\xbf";
constexpr std::string_view blanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// One row, cell by cell, written over the copy of the text.
class CsvRow {
 public:
  /// `line` is the row in the source, `out` where its copy begins.
  CsvRow(const SourceText& source, std::string_view line, char* out)
      : source_(source), at_(line.data()), end_(line.data() + line.size()), out_(out) {}

  void run() {
    char* const begin = out_;
    char* const end = out_ + (end_ - at_);
    bool heading = false;
    for (int cell = 0;; ++cell) {
      const char* const place = at_;
      char* const copied = out_;
      readCell();
      const std::string_view content = trimmed({copied, static_cast<std::size_t>(out_ - copied)});
      if (cell == 0) heading = content == "tag" && !quoted_;
      if (content.empty() && !empty_) empty_ = place;
      if (!content.empty() && empty_) throw source_.error(empty_, "an empty cell before others");
      if (!content.empty() && !heading) checkWhole(content, place + (content.data() - copied));
      if (at_ == end_) break;
      ++at_;
      *out_++ = ' ';
    }
    // Two quotes that became one leave the copy shorter.
    while (out_ != end) *out_++ = ' ';
    if (heading) std::fill(begin, end, ' ');
  }

 private:
  void readCell() {
    while (at_ != end_ && blanks.find(*at_) != std::string_view::npos) *out_++ = *at_++;
    if (at_ != end_ && *at_ == '"') return readQuoted();
    while (at_ != end_ && *at_ != ',') *out_++ = *at_++;
  }

  /// Only a row of one cell, a line of text, holds blanks: they would divide the cell of an element. `place` is where
  /// the content is in the source.
  void checkWhole(std::string_view content, const char* place) {
    const std::size_t blank = content.find_first_of(blanks);
    if (blank != std::string_view::npos && !divided_) divided_ = place + blank;
    if (++filled_ > 1 && divided_) throw source_.error(divided_, "a blank inside a cell; is a comma missing?");
  }

  void readQuoted() {
    const char* const quote = at_++;
    quoted_ = true;
    *out_++ = ' ';
    for (;; ++at_) {
      if (at_ == end_) throw source_.error(quote, "this quote does not end on its line");
      if (*at_ == '"') {
        if (at_ + 1 == end_ || at_[1] != '"') break;
        ++at_;
      }
      *out_++ = *at_;
    }
    ++at_;
    *out_++ = ' ';
    while (at_ != end_ && *at_ != ',') {
      if (blanks.find(*at_) == std::string_view::npos) throw source_.error(at_, "a comma follows a cell in quotes");
      *out_++ = *at_++;
    }
  }

  const SourceText& source_;
  const char* at_;
  const char* end_;
  char* out_;
  /// The first of the empty cells before this one.
  const char* empty_ = nullptr;
  /// The first blank inside a cell.
  const char* divided_ = nullptr;
  int filled_ = 0;
  bool quoted_ = false;
};

}  // namespace

bool looksLikeCsv(std::string_view text) {
  if (text.starts_with(byteOrderMark)) text.remove_prefix(byteOrderMark.size());
  TextScanner scanner(text);
  while (!scanner.atEnd()) {
    const std::string_view line = trimmed(scanner.nextLine());
    if (line.empty() || line.front() == '#') continue;
    const std::size_t end = line.find_first_of(" \t,");
    return line.front() == '"' || (end != std::string_view::npos && line[end] == ',');
  }
  return false;
}

std::string linesOfCsv(const SourceText& source) {
  std::string lines(source.text);
  TextScanner scanner(source.text);
  bool first = true;
  while (!scanner.atEnd()) {
    std::string_view line = scanner.nextLine();
    if (first && line.starts_with(byteOrderMark)) line.remove_prefix(byteOrderMark.size());
    first = false;
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;
    CsvRow(source, line, lines.data() + (line.data() - source.begin())).run();
  }
  return lines;
}

}  // namespace quiver::detail
