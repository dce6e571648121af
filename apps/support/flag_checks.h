#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace quiver::app {

// Checks of flags' values whose messages say what would do. Used in place of CLI11's own, which print the range of a
// double in full and take the numbers behind words.

/// A word of the table, turned into its value.
template <typename Value>
CLI::Validator wordOf(const std::map<std::string, Value>& words) {
  return CLI::Validator(
      [words](std::string& word) -> std::string {
        const auto found = words.find(word);
        if (found != words.end()) {
          word = std::to_string(static_cast<int>(found->second));
          return "";
        }
        std::string known;
        for (const auto& entry : words) known += (known.empty() ? "" : ", ") + entry.first;
        return fmt::format("'{}' is none of {}", word, known);
      },
      "");
}

/// A finite number of at least `least`, or more than it.
inline CLI::Validator numberFrom(double least, bool included = true) {
  return CLI::Validator(
      [least, included](std::string& word) -> std::string {
        double value = 0.0;
        const bool number = CLI::detail::lexical_cast(word, value) && std::isfinite(value);
        if (number && (value > least || (included && value == least))) return "";
        return fmt::format("'{}' is no number {} {}", word, included ? "of at least" : "greater than", least);
      },
      "");
}

/// An id: a whole number that is not negative.
inline CLI::Validator vertexId() {
  return CLI::Validator(
      [](std::string& word) -> std::string {
        std::int64_t id = -1;
        const char* const end = word.data() + word.size();
        const auto [rest, error] = std::from_chars(word.data(), end, id);
        if (error == std::errc() && rest == end && id >= 0) return "";
        return fmt::format("'{}' is no id of a vertex", word);
      },
      "");
}

/// The path of an output: not empty, as that of an unset variable is.
inline CLI::Validator outputPath() {
  return CLI::Validator(
      [](std::string& word) -> std::string { return word.empty() ? "the path of the file to write is empty" : ""; },
      "");
}

}  // namespace quiver::app
