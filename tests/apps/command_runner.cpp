#include "tests/apps/command_runner.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

namespace quiver::test {

const char* const square =
    "VERTEX_SE2 0 0 0 0\n"
    "VERTEX_SE2 1 1.1 0 1.5\n"
    "VERTEX_SE2 2 1 1.2 3.1\n"
    "VERTEX_SE2 3 0.2 0.9 -1.5\n"
    "EDGE_SE2 0 1 1 0 1.5707963 100 0 0 100 0 400\n"
    "EDGE_SE2 1 2 1 0 1.5707963 100 0 0 100 0 400\n"
    "EDGE_SE2 2 3 1.05 0 1.5707963 100 0 0 100 0 400\n"
    "EDGE_SE2 3 0 1 0.01 1.5707963 100 0 0 100 0 400\n";

namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

CommandTest::CommandTest() {
  std::string pattern = (std::filesystem::temp_directory_path() / "quiver-apps-XXXXXX").string();
  folder_ = mkdtemp(pattern.data());
}

CommandTest::~CommandTest() {
  std::error_code error;
  std::filesystem::permissions(folder_, std::filesystem::perms::owner_all, error);
  std::filesystem::remove_all(folder_, error);
}

CommandResult CommandTest::run(const std::string& arguments) const {
  // Everything in braces shares the redirections, so arguments may go on with commands of the shell.
  const std::string line = fmt::format("cd '{}' && {{ '{}' {}\n}} > .stdout 2> .stderr < /dev/null", folder_.string(),
                                       QUIVER_COMMAND, arguments);
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(folder_ / ".stdout"), contents(folder_ / ".stderr")};
}

nlohmann::json CommandTest::optimize(const std::string& arguments, int exitCode) const {
  const CommandResult result = run("optimize " + arguments + " --json report.json");
  EXPECT_EQ(result.exitCode, exitCode) << arguments << '\n' << result.out << result.err;
  return nlohmann::json::parse(read("report.json"), nullptr, false);
}

std::string CommandTest::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
  return name;
}

std::string CommandTest::read(const std::string& name) const { return contents(folder_ / name); }

std::string publishedGraph(const std::string& name) {
  std::filesystem::path data;
  if (const char* folder = std::getenv("QUIVER_DATA")) {
    data = folder;
  } else {
    for (std::filesystem::path at = std::filesystem::current_path(); data.empty() && at != at.root_path();
         at = at.parent_path()) {
      if (std::filesystem::exists(at / "shared/data")) data = at / "shared/data";
    }
  }
  const std::filesystem::path path = data / (name + ".g2o");
  return !data.empty() && std::filesystem::exists(path) ? path.string() : "";
}

std::string whyMissing(const std::string& file) {
  return file + " is not there: published files are not ours to pass on, so a clone alone does not have them";
}

}  // namespace quiver::test
