#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/core/registry/registry.h>
#include <quiver/version.h>

namespace quiver::app {
namespace {

/// "did you mean …" for a word the parser does not know, or nothing.
std::string suggestion(const CLI::App& parser, const std::vector<std::string>& arguments) {
  const std::vector<CLI::App*> chosen = parser.get_subcommands();
  std::vector<std::string> candidates;
  if (chosen.empty()) {
    for (const CLI::App* command : parser.get_subcommands({})) candidates.push_back(command->get_name());
  } else {
    for (const CLI::Option* option : chosen.front()->get_options()) {
      for (const std::string& name : option->get_lnames()) candidates.push_back("--" + name);
    }
  }
  for (const std::string& argument : arguments) {
    const std::string word = argument.substr(0, argument.find('='));
    const bool known = std::find(candidates.begin(), candidates.end(), word) != candidates.end();
    const bool flag = word.size() > 2 && word.compare(0, 2, "--") == 0;
    if (known || flag == chosen.empty()) continue;
    const std::string near = nearestWord(word, candidates);
    if (!near.empty()) return fmt::format("; '{}': did you mean '{}'?", word, near);
  }
  return "";
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
  try {
    parser.parse(count, words);
  } catch (const CLI::Success& asked) {  // --help, --version
    return parser.exit(asked) == 0 ? exitSuccess : exitInternal;
  } catch (const CLI::ParseError& error) {
    const std::vector<std::string> arguments(words + 1, words + count);
    fmt::print(stderr, "quiver: {}{}\nquiver --help lists the commands, quiver COMMAND --help their flags.\n",
               error.what(), suggestion(parser, arguments));
    return exitUsage;
  }
  return exitCode;
}

}  // namespace
}  // namespace quiver::app

int main(int count, char** words) {
  try {
    return quiver::app::runCommand(count, words);
  } catch (...) {
    return quiver::app::reportCurrentException();
  }
}
