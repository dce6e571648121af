#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace quiver::bench {

/// What the programs take: [--json FILE | --benchmark_out=FILE] [--rounds N] [--any-blas] [GRAPH…]; graphs default to
/// those of QUIVER_DATA.
struct Arguments {
  std::string json;
  int rounds = 5;
  bool anyBlas = false;  // also measure peers on a slow BLAS
  std::vector<std::string> graphs;

  Arguments(int count, char** words, const std::vector<std::string>& names) {
    for (int i = 1; i < count; ++i) {
      const std::string word = words[i];
      if (word == "--json" && i + 1 < count) {
        json = words[++i];
      } else if (word.starts_with("--benchmark_out=")) {
        json = word.substr(word.find('=') + 1);
      } else if (word == "--rounds" && i + 1 < count) {
        rounds = std::max(1, std::atoi(words[++i]));
      } else if (word == "--any-blas") {
        anyBlas = true;
      } else if (!word.starts_with("--")) {
        graphs.push_back(word);
      }
    }
    if (!graphs.empty()) return;
    const char* folder = std::getenv("QUIVER_DATA");
    for (const std::string& name : names) {
      const std::filesystem::path file = std::filesystem::path(folder ? folder : "../shared/data") / (name + ".g2o");
      if (std::filesystem::exists(file)) graphs.push_back(file.string());
    }
  }
};

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

template <typename Work>
double secondsOf(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Waits until threads of what ran before have gone to sleep: those of OpenMP look for work for some milliseconds, on
/// cores that the next to be measured needs. Waits busily: a core that sleeps is slow for a while.
inline void settle() {
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(20)) {
  }
}

/// Neither side pays for what the other has freed: the C library joins small freed blocks at the next large allocation.
inline void joinFreedBlocks() {
  constexpr std::size_t large = std::size_t{1} << 16;
  const std::vector<char> block(large);
  [[maybe_unused]] const volatile char* const kept = block.data();
}

/// Medians of two works that take turns, and the median of their ratios, so that a busy machine slows both.
struct Pair {
  double ours = 0.0;
  double theirs = 0.0;
  double ratio = 0.0;
};
template <typename Ours, typename Theirs>
Pair comparePairs(int rounds, Ours&& ours, Theirs&& theirs) {
  std::vector<double> a;
  std::vector<double> b;
  std::vector<double> ratios;
  for (int round = 0; round < rounds; ++round) {
    joinFreedBlocks();
    a.push_back(ours());
    joinFreedBlocks();
    b.push_back(theirs());
    ratios.push_back(b.back() / a.back());
  }
  return {median(a), median(b), median(ratios)};
}

/// Rows of named numbers, written as a JSON array; what is not finite is null.
class JsonRows {
 public:
  void begin(const std::string& name) { rows_.push_back(fmt::format("  {{\"name\": \"{}\"", name)); }
  void add(const std::string& key, double value) {
    rows_.back() += fmt::format(", \"{}\": {}", key, std::isfinite(value) ? fmt::format("{:.9g}", value) : "null");
  }
  void write(const std::string& file) const {
    if (file.empty()) return;
    std::ofstream out(file);
    out << "[\n";
    for (std::size_t i = 0; i < rows_.size(); ++i) out << rows_[i] << (i + 1 < rows_.size() ? "},\n" : "}\n");
    out << "]\n";
  }

 private:
  std::vector<std::string> rows_;
};

}  // namespace quiver::bench
