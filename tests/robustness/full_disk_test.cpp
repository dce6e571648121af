#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "scratch_folder.h"

namespace quiver::test {
namespace {

/// Runs the command after `prepare` in a process of its own; its exit code, or −1 if a signal ended it. What it says
/// goes to the file `said`.
int runCommand(std::vector<std::string> arguments, const std::string& said, const std::function<void()>& prepare = {}) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (!std::freopen(said.c_str(), "w", stderr) || !std::freopen("/dev/null", "w", stdout)) ::_exit(120);
    if (prepare) prepare();
    std::string command = QUIVER_COMMAND;
    std::vector<char*> words{command.data()};
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    ::execv(QUIVER_COMMAND, words.data());
    ::_exit(121);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// A small file system in memory, full up to a few kilobytes; `mounted` tells whether that was allowed.
class SmallDisk {
 public:
  explicit SmallDisk(const std::string& path) : path_(path) {
    std::filesystem::create_directory(path);
    mounted = ::mount("tmpfs", path.c_str(), "tmpfs", 0, "size=256k") == 0;
    reason = mounted ? "" : std::strerror(errno);
  }
  ~SmallDisk() {
    if (mounted) ::umount(path_.c_str());
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool mounted = false;
  std::string reason;

 private:
  std::string path_;
};

void write(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

TEST(FullDisk, OptimizeLeavesTheOldFileWhole) {
  const ScratchFolder folder;
  const SmallDisk disk(folder.file("disk"));
  if (!disk.mounted) GTEST_SKIP() << "no small file system can be mounted here: " << disk.reason;
  write(folder.file("in.g2o"), ringText(4000, 0.1));  // some 500 kB as written
  const std::string out = folder.file("disk/out.g2o");
  write(out, "# old\n");
  EXPECT_EQ(runCommand({"optimize", folder.file("in.g2o"), "-o", out, "--iterations", "1"}, folder.file("said")), 6);
  EXPECT_EQ(contents(out), "# old\n");
  EXPECT_NE(contents(folder.file("said")).find("No space left"), std::string::npos) << contents(folder.file("said"));
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path() / "disk")) ++files;
  EXPECT_EQ(files, 1) << "the unfinished file must not stay and fill the disk";
}

/// A limit on the size of files stands in for a disk of that size, where none can be mounted too.
TEST(FullDisk, AFileThatMayNotGrowLeavesTheOldFileWhole) {
  const ScratchFolder folder;
  write(folder.file("in.g2o"), ringText(4000, 0.1));
  const std::string out = folder.file("out.g2o");
  for (const std::string name : {"out.g2o", "out.g2o.gz", "out.g2o.bz2"}) {
    write(folder.file(name), "# old\n");
    const auto limit = [] {
      const rlimit size{16384, 16384};
      if (::setrlimit(RLIMIT_FSIZE, &size) != 0) ::_exit(122);
      ::signal(SIGXFSZ, SIG_IGN);
    };
    const int code = runCommand({"optimize", folder.file("in.g2o"), "-o", folder.file(name), "--iterations", "1"},
                                folder.file("said"), limit);
    EXPECT_EQ(code, 6) << name << contents(folder.file("said"));
    EXPECT_EQ(contents(folder.file(name)), "# old\n") << name;
    EXPECT_NE(contents(folder.file("said")).find(name), std::string::npos) << contents(folder.file("said"));
  }
}

TEST(FullDisk, ConvertAndReportsEndTheSameWay) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "there is no /dev/full";
  const ScratchFolder folder;
  write(folder.file("in.g2o"), ringText(10, 0.1));
  const std::string said = folder.file("said");
  EXPECT_EQ(runCommand({"convert", folder.file("in.g2o"), "/dev/full"}, said), 6) << contents(said);
  EXPECT_EQ(runCommand({"optimize", folder.file("in.g2o"), "--json", "/dev/full"}, said), 6) << contents(said);
}

}  // namespace
}  // namespace quiver::test
