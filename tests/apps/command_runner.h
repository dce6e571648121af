#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace quiver::test {

/// What a run of the command left.
struct CommandResult {
  int exitCode = -1;
  std::string out;
  std::string err;
};

/// A test with a folder of its own, in which it runs the command.
class CommandTest : public testing::Test {
 protected:
  CommandTest();
  ~CommandTest() override;

  /// Runs `quiver ARGUMENTS` through the shell, in the folder.
  CommandResult run(const std::string& arguments) const;
  /// Runs `quiver optimize ARGUMENTS --json`, expects the exit code, and returns what it reports.
  nlohmann::json optimize(const std::string& arguments, int exitCode = 0) const;

  std::string write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// The published graph of that name, beside the checkout or where QUIVER_DATA points; empty if there is none. Tests of
/// published graphs are skipped then: the files are not ours to pass on, so a clone alone does not have them.
std::string publishedGraph(const std::string& name);
/// Why a test that needs such a file is skipped.
std::string whyMissing(const std::string& file);

/// A square of four poses in the plane, the last one off its place, with a loop closure; vertex 0 is not fixed.
extern const char* const square;

}  // namespace quiver::test
