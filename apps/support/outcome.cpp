#include <quiver/apps/support/outcome.h>

#include <cstdio>
#include <new>

#include <fmt/format.h>

#include <quiver/apps/support/standard_streams.h>

namespace quiver::app {
namespace {

int report(const char* message, ExitCode code) {
  tell(stderr, "{}\n", message);
  return code;
}

}  // namespace

ExitCode exitCodeOf(Status status) {
  switch (status) {
    case Status::converged:
    case Status::iterationLimit:
    case Status::stalled:
    case Status::nothingToOptimise:
      return exitSuccess;
    case Status::timeLimit:
    case Status::interrupted:
      return exitInterrupted;
    case Status::numericalFailure:
    case Status::memoryLimit:
      return exitNumericalFailure;
  }
  return exitInternal;
}

int reportCurrentException(bool plugins) {
  try {
    throw;
  } catch (const UsageError& error) {
    return report(error.what(), exitUsage);
  } catch (const OutputError& error) {
    return report(error.what(), exitOutput);
  } catch (const LogicError& error) {
    tell(stderr, "quiver has a defect, please report it: {}\n", error.what());
    return exitInternal;
  } catch (const Error& error) {
    return report(error.what(), exitBadInput);
  } catch (const std::bad_alloc&) {
    return report("out of memory", exitNumericalFailure);
  } catch (const std::exception& error) {
    if (plugins) return report(fmt::format("a function of a plugin threw: {}", error.what()).c_str(), exitBadInput);
    tell(stderr, "quiver has a defect, please report it: {}\n", error.what());
    return exitInternal;
  } catch (...) {
    if (plugins) return report("a function of a plugin threw what is no exception of the standard", exitBadInput);
    tell(stderr, "quiver has a defect, please report it: something unknown was thrown\n");
    return exitInternal;
  }
}

}  // namespace quiver::app
