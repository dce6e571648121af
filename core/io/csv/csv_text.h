#pragma once

#include <string>
#include <string_view>

#include <quiver/core/io/text/source_text.h>

namespace quiver::detail {

/// Whether a text is a table of elements: in its first line that is no comment a comma follows the first word, or that
/// word is in quotes.
bool looksLikeCsv(std::string_view text);

/// The table as lines of a .g2o file, of the same length: commas and quotes become blanks, rows that begin with "tag"
/// (headings) become empty, and every byte else stays where it is, so that messages name the places of the table.
/// Comments stay as they are; in a quoted cell commas stay and two quotes become one. Empty cells may end a row. Throws
/// ParseError for an empty cell elsewhere, for a blank inside a cell that is not the only one of its row, and for a
/// quote that does not end on its line.
std::string linesOfCsv(const SourceText& source);

}  // namespace quiver::detail
