#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/stopwatch.h>
#include <quiver/plugins/builtin.h>

#include "scratch_folder.h"

namespace quiver::test {
namespace {

/// Saves two graphs in turn to one file, for ever; writes a byte to `ready` before the first. An error ends the
/// process.
[[noreturn]] void saveForEver(const std::string& path, const Graph& a, const Graph& b, int ready) noexcept {
  const char byte = 1;
  if (::write(ready, &byte, 1) != 1) ::_exit(1);
  while (true) {
    writeGraph(path, b, {.threads = 1});
    writeGraph(path, a, {.threads = 1});
  }
}

/// Runs saveForEver in a process of its own and kills it after that many microseconds.
void saveAndKill(const std::string& path, const Graph& a, const Graph& b, unsigned microseconds) {
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) saveForEver(path, a, b, pipe[1]);
  char byte = 0;
  ASSERT_EQ(::read(pipe[0], &byte, 1), 1);
  ::usleep(microseconds);
  ASSERT_EQ(::kill(child, SIGKILL), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << "the child ended by itself";
  ::close(pipe[0]);
  ::close(pipe[1]);
}

/// Microseconds in which a process saves some three times: kills within it meet every part of a saving.
unsigned someSavings(const std::string& path, const Graph& a, const Graph& b) {
  const Stopwatch watch;
  writeGraph(path, b, {.threads = 1});
  writeGraph(path, a, {.threads = 1});
  return std::max(1000U, static_cast<unsigned>(1.5e6 * watch.seconds()));
}

/// Unfinished files that killed processes left, removed.
int removeUnfinished(const std::filesystem::path& folder) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".tmp") continue;
    std::filesystem::remove(entry.path());
    ++count;
  }
  return count;
}

TEST(KillDuringSave, TheOldOrTheNewFileIsWhole) {
  const auto registry = builtinRegistry();
  const Graph a = readGraphText(ringText(1500, 0.0), "a", registry, {.threads = 1});
  const Graph b = readGraphText(ringText(1500, 0.123), "b", registry, {.threads = 1});
  const std::string textA = graphText(a, {.threads = 1});
  const std::string textB = graphText(b, {.threads = 1});
  const ScratchFolder folder;
  const std::string path = folder.file("graph.g2o");
  const unsigned window = someSavings(path, a, b);

  std::mt19937 random(1);
  constexpr int kills = 1000;
  int old = 0;
  int fresh = 0;
  int unfinished = 0;
  for (int i = 0; i < kills; ++i) {
    ASSERT_NO_FATAL_FAILURE(saveAndKill(path, a, b, static_cast<unsigned>(random() % window)));
    const std::string text = contents(path);
    ASSERT_TRUE(text == textA || text == textB) << "kill " << i << " left " << text.size() << " of " << textA.size();
    (text == textA ? old : fresh) += 1;
    unfinished += removeUnfinished(folder.path());
  }
  // The kills must have met savings under way, and both outcomes.
  EXPECT_GT(unfinished, kills / 20);
  EXPECT_GT(old, kills / 20);
  EXPECT_GT(fresh, kills / 20);
}

}  // namespace
}  // namespace quiver::test
