#pragma once

#include <quiver/core/algorithm/summary.h>
#include <quiver/core/util/error.h>

namespace quiver::app {

/// What the command tells its caller; a contract.
enum ExitCode {
  exitSuccess = 0,           ///< converged, iteration limit, stalled, nothing to optimise: read the status
  exitInternal = 1,          ///< a defect of quiver
  exitUsage = 2,             ///< the command line makes no sense
  exitBadInput = 3,          ///< a file, graph or plugin is wrong
  exitNumericalFailure = 4,  ///< no solution, or more memory needed than allowed
  exitInterrupted = 5,       ///< interrupted or out of time; the best estimate is saved
  exitOutput = 6             ///< an output cannot be written
};

/// The command line makes no sense.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// An output cannot be written.
class OutputError : public Error {
 public:
  using Error::Error;
};

ExitCode exitCodeOf(Status status);

/// The exit code for the exception being handled, whose message it prints to standard error. With plugins, exceptions
/// that are none of quiver's are theirs.
int reportCurrentException(bool plugins);

}  // namespace quiver::app
