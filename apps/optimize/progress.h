#pragma once

#include <cstdio>
#include <string>

#include <quiver/core/algorithm/summary.h>

namespace quiver::app {

/// Tells of a running optimisation: one line that updates in place on a terminal, one line an iteration otherwise.
class Progress {
 public:
  /// `stream` is null for silence.
  explicit Progress(std::FILE* stream);

  void iteration(const IterationReport& report);
  /// Ends the line in place and prints what remains to be said: on a terminal the table too.
  void finish(const Summary& summary);

 private:
  std::FILE* stream_;
  bool terminal_ = false;
  bool begun_ = false;
};

/// The sentences after the table: what was decided, how it ended, chi2 before and after, time.
std::string closingText(const Summary& summary);

}  // namespace quiver::app
