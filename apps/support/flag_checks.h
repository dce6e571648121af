#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <fmt/ranges.h>
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

/// A word of the list.
inline CLI::Validator wordAmong(const std::vector<std::string>& words) {
  return CLI::Validator(
      [words](std::string& word) -> std::string {
        if (std::find(words.begin(), words.end(), word) != words.end()) return "";
        return fmt::format("'{}' is none of {}", word, fmt::join(words, ", "));
      },
      "");
}

/// Whether a word is a decimal number, which goes to `value`: hexadecimal ones, as files, are refused.
inline bool isDecimal(const std::string& word, double& value) {
  return word.find_first_of("xX") == std::string::npos && CLI::detail::lexical_cast(word, value);
}

/// A finite number of at least `least`, or more than it.
inline CLI::Validator numberFrom(double least, bool included = true) {
  return CLI::Validator(
      [least, included](std::string& word) -> std::string {
        double value = 0.0;
        const bool number = isDecimal(word, value) && std::isfinite(value);
        if (number && (value > least || (included && value == least))) return "";
        return fmt::format("'{}' is no number {} {}", word, included ? "of at least" : "greater than", least);
      },
      "");
}

/// A number between two others, which are included.
inline CLI::Validator numberBetween(double least, double most) {
  return CLI::Validator(
      [least, most](std::string& word) -> std::string {
        double value = 0.0;
        if (isDecimal(word, value) && value >= least && value <= most) return "";
        return fmt::format("'{}' is no number from {} to {}", word, least, most);
      },
      "");
}

/// A whole number between two others, which are included. In decimal digits: CLI11 itself would read 010 as eight.
template <typename Integer>
CLI::Validator wholeNumber(Integer least, Integer most = std::numeric_limits<Integer>::max()) {
  return CLI::Validator(
      [least, most](std::string& word) -> std::string {
        Integer value{};
        const char* const end = word.data() + word.size();
        const auto [rest, error] = std::from_chars(word.data(), end, value);
        if (error != std::errc() || rest != end || value < least || value > most) {
          const bool open = most == std::numeric_limits<Integer>::max() && error != std::errc::result_out_of_range;
          return fmt::format("'{}' is no whole number {}", word,
                             open ? fmt::format("of at least {}", least) : fmt::format("from {} to {}", least, most));
        }
        word = fmt::format("{}", value);
        return "";
      },
      "");
}

/// An id: a whole number that is not negative.
inline CLI::Validator vertexId() {
  return CLI::Validator(
      [](std::string& word) -> std::string {
        std::string number = word;
        if (!wholeNumber<std::int64_t>(0)(number).empty()) return fmt::format("'{}' is no id of a vertex", word);
        word = number;
        return "";
      },
      "");
}

/// Text that is not empty, as that of an unset variable is; `what` says what it would be.
inline CLI::Validator filled(const std::string& what) {
  return CLI::Validator(
      [what](std::string& word) -> std::string { return word.empty() ? fmt::format("{} is empty", what) : ""; }, "");
}
inline CLI::Validator inputPath() { return filled("the path of the file to read"); }
inline CLI::Validator outputPath() { return filled("the path of the file to write"); }

/// The words of a list between its separators, empty ones too.
inline std::vector<std::string> splitList(const std::string& text, char separator) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == separator) {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

/// A flag that takes a list, and may be given again to go on with it: every word must be there and pass the check. The
/// first list that is given replaces what `values` holds.
template <typename Value>
CLI::Option* addList(CLI::App& command, const std::string& name, std::vector<Value>& values, const std::string& text,
                     const CLI::Validator& check, char separator = ',') {
  const auto take = [&values, name, check, separator](const std::vector<std::string>& lists) {
    values.clear();
    for (const std::string& list : lists) {
      for (std::string word : splitList(list, separator)) {
        if (word.empty() && !list.empty())
          throw CLI::ValidationError(name,
                                     fmt::format("in the list '{}' a word is missing at a '{}'", list, separator));
        const std::string objection = check(word);
        if (!objection.empty()) throw CLI::ValidationError(name, objection);
        if (!CLI::detail::lexical_cast(word, values.emplace_back()))
          throw CLI::ValidationError(name, fmt::format("'{}' is out of bounds", word));
      }
    }
  };
  return command.add_option_function<std::vector<std::string>>(name, take, text)->allow_extra_args(false);
}

}  // namespace quiver::app
