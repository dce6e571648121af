#pragma once

#include <span>
#include <string>
#include <vector>

#include <quiver/quiver.h>

#include "peers/measure.h"

namespace quiver::bench {

/// Levenberg–Marquardt for exactly so many trial steps, two threads.
Options untilIterations(int iterations);
/// The median of an iteration's seconds.
double iterationSeconds(const Summary& summary);

/// From a file to its 20th trial step, in processes of their own, against Ceres's dense and sparse Schur solver.
struct PublishedWhole {
  Pair dense;
  Pair sparse;
};
/// One for each file; none where Ceres is not installed. To be called before the process has started any thread.
std::vector<PublishedWhole> measureWholes(std::span<const std::string> files, int rounds);

/// Measures iterations of each file against Ceres, and what a hint about the elimination is worth; prints and reports
/// these and `wholes`.
void comparePublished(std::span<const std::string> files, std::span<const PublishedWhole> wholes, int rounds,
                      JsonRows& json);

}  // namespace quiver::bench
