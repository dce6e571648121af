#include <algorithm>
#include <string>
#include <vector>

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/support/freed_memory.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/standard_streams.h>
#include <quiver/core/registry/registry.h>
#include <quiver/version.h>

namespace quiver::app {
namespace {

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string near = nearestWord(word, candidates);
  return near.empty() ? "" : fmt::format(", did you mean '{}'?", near);
}

/// What is wrong where a command (`name` is "quiver") or what it is to do is missing or unknown.
std::string describeMissingCommand(const std::string& name, const std::string& word,
                                   const std::vector<std::string>& commands) {
  const std::string all = fmt::format("there are {}", fmt::join(commands, ", "));
  if (word.empty()) return fmt::format("{} is to do what? {}", name, all);
  if (word[0] == '-') return fmt::format("behind {}, what it is to do comes before '{}'; {}", name, word, all);
  const std::string near = suggestion(word, commands);
  return fmt::format("{} does not know '{}'{}", name, word, near.empty() ? "; " + all : near);
}

/// What is wrong with a command line, with the nearest command or flag where one is unknown.
std::string describeUsageError(const CLI::App& parser, const CLI::ParseError& error,
                               const std::vector<std::string>& arguments) {
  const CLI::App* command = &parser;
  std::size_t depth = 0;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    ++depth;
  }
  std::vector<std::string> commands;
  for (const CLI::App* further : command->get_subcommands({})) commands.push_back(further->get_name());
  if (!commands.empty()) {
    const std::string word = depth < arguments.size() ? arguments[depth] : "";
    return describeMissingCommand(depth == 0 ? "quiver" : command->get_name(), word, commands);
  }
  std::vector<std::string> flags{"--help"};
  for (const CLI::Option* option : command->get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  for (const std::string& argument : arguments) {
    const std::string word = argument.substr(0, argument.find('='));
    if (word.compare(0, 2, "--") != 0 || std::find(flags.begin(), flags.end(), word) != flags.end()) continue;
    const std::string near = suggestion(word, flags);
    if (!near.empty()) return fmt::format("{} has no flag '{}'{}", command->get_name(), word, near);
  }
  return error.what();
}

int runCommand(int count, char** words) {
  int exitCode = exitSuccess;
  CLI::App parser("quiver: graph optimization");
  parser.name("quiver");
  parser.set_version_flag("--version", "quiver " QUIVER_VERSION);
  parser.require_subcommand(1);
  parser.footer(
      "`quiver COMMAND --help` tells more. A first run:\n"
      "  quiver simulate sphere -o sphere.g2o\n"
      "  quiver optimize sphere.g2o -o optimised.g2o\n"
      "  quiver plot optimised.g2o --before sphere.g2o -o sphere.svg");
  addOptimizeCommand(parser, exitCode);
  addInfoCommand(parser, exitCode);
  addListCommand(parser, exitCode);
  addConvertCommand(parser, exitCode);
  addSimulateCommand(parser, exitCode);
  addPlotCommand(parser, exitCode);
  addEvaluateCommand(parser, exitCode);
  addCheckCommand(parser, exitCode);
  try {
    parser.parse(count, words);
  } catch (const CLI::Success& asked) {  // --help, --version
    return parser.exit(asked) == 0 ? exitSuccess : exitInternal;
  } catch (const CLI::ParseError& error) {
    const std::vector<std::string> arguments(words + 1, words + count);
    tell(stderr, "quiver: {}\nquiver --help lists the commands, quiver COMMAND --help their flags.\n",
         describeUsageError(parser, error, arguments));
    return exitUsage;
  }
  return exitCode;
}

/// Whether a command line asks for plugins.
bool namesPlugins(const std::vector<std::string>& arguments) {
  return std::any_of(arguments.begin(), arguments.end(), [](const std::string& argument) {
    return argument == "check" || argument.rfind("--plugin", 0) == 0;
  });
}

/// What a command prints is its output too: text that got lost is no success.
int checkStandardOutput(int exitCode) {
  const std::string failure = standardOutputFailure();
  if (failure.empty() || exitCode != exitSuccess) return exitCode;
  tell(stderr, "<stdout>: cannot be written: {}\n", failure);
  return exitOutput;
}

}  // namespace
}  // namespace quiver::app

int main(int count, char** words) {
  quiver::app::holdStandardStreams();
  quiver::app::keepFreedMemory();
  int exitCode = 0;
  try {
    exitCode = quiver::app::runCommand(count, words);
  } catch (...) {
    exitCode = quiver::app::reportCurrentException(quiver::app::namesPlugins({words + 1, words + count}));
  }
  return quiver::app::checkStandardOutput(exitCode);
}
