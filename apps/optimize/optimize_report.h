#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <quiver/apps/support/initial_guess.h>
#include <quiver/core/algorithm/summary.h>

namespace quiver::app {

/// What became of the covariances that were asked for.
struct MarginalsReport {
  std::int64_t vertices = 0;
  std::vector<std::int64_t> undetermined;
  /// Of the variance known least.
  double relativeError = 0.0;
  /// What kept them from being had; empty if they are written.
  std::string reason;
  bool stopped = false;
};

/// Everything a run of `quiver optimize` has to report.
struct OptimizeReport {
  Summary summary;
  InitialGuess guess;
  /// chi2 of the file's own estimates; NaN if some are missing.
  double fileChi2 = 0.0;
  double loadSeconds = 0.0;
  double initializeSeconds = 0.0;
  double saveSeconds = 0.0;
  std::optional<MarginalsReport> marginals;
  /// NaN if none were computed.
  double marginalsSeconds = std::numeric_limits<double>::quiet_NaN();
  double totalSeconds = 0.0;
};

/// The JSON that the command promises; later versions only add to it. `input` is describeInput()'s.
nlohmann::ordered_json describeRun(const OptimizeReport& report, const nlohmann::ordered_json& input);

/// The most memory the process has held, in bytes.
std::int64_t peakMemoryBytes();

}  // namespace quiver::app
