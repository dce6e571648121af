#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <quiver/core/io/files/input_file.h>
#include <quiver/core/io/files/output_file.h>
#include <quiver/core/util/error.h>
#include <tests/io/temporary_folder.h>

namespace quiver {
namespace {

namespace fs = std::filesystem;
using test::messageOf;
using test::readBytes;
using test::writeBytes;

class OutputFileTest : public testing::Test {
 protected:
  static void store(const std::string& path, const std::string& text) {
    OutputFile file(path);
    file.write(text);
    file.commit();
  }

  test::TemporaryFolder folder_;
};

TEST_F(OutputFileTest, AppearsOnCommitOnly) {
  const std::string path = folder_.path("out");
  {
    OutputFile file(path);
    file.write("some");
    EXPECT_FALSE(fs::exists(path));
    file.write(" text");
    file.commit();
    EXPECT_EQ(readBytes(path), "some text");
  }
  EXPECT_EQ(readBytes(path), "some text");
  EXPECT_EQ(folder_.fileCount(), 1U);
}

TEST_F(OutputFileTest, LeavesTheOldFileWithoutCommit) {
  const std::string path = folder_.path("out");
  writeBytes(path, "old");
  {
    OutputFile file(path);
    file.write(std::string(3'000'000, 'x'));
    EXPECT_EQ(readBytes(path), "old");
  }
  EXPECT_EQ(readBytes(path), "old");
  EXPECT_EQ(folder_.fileCount(), 1U);
}

TEST_F(OutputFileTest, WritesSmallAndLargePiecesInOrder) {
  std::string expected;
  OutputFile file(folder_.path("out"));
  for (const std::size_t size : {3UL, 300'000UL, 0UL, 7UL, 262'144UL, 262'143UL, 1'000'000UL, 5UL}) {
    const std::string piece(size, static_cast<char>('a' + expected.size() % 26));
    file.write(piece);
    expected += piece;
  }
  file.commit();
  EXPECT_EQ(readBytes(folder_.path("out")), expected);
}

TEST_F(OutputFileTest, CompressesBySuffixAndWithoutTimeStamps) {
  const std::string text(2'000'000, 'z');
  for (const char* name : {"a.gz", "a.bz2"}) {
    store(folder_.path(name), text);
    const std::string first = readBytes(folder_.path(name));
    EXPECT_LT(first.size(), text.size() / 10);
    EXPECT_EQ(InputFile(folder_.path(name)).text(), text);
    store(folder_.path(name), text);
    EXPECT_EQ(readBytes(folder_.path(name)), first);
  }
}

TEST_F(OutputFileTest, KeepsTheModeOfTheTarget) {
  const std::string path = folder_.path("out");
  writeBytes(path, "old");
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  store(path, "new");
  struct stat status;
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640U);
}

TEST_F(OutputFileTest, GivesNewFilesTheUsualMode) {
  writeBytes(folder_.path("usual"), "");
  store(folder_.path("new"), "");
  EXPECT_EQ(fs::status(folder_.path("new")).permissions(), fs::status(folder_.path("usual")).permissions());
}

TEST_F(OutputFileTest, FollowsSymbolicLinks) {
  writeBytes(folder_.path("real"), "old");
  fs::create_symlink("real", folder_.path("link"));
  fs::create_symlink("absent", folder_.path("dangling"));
  store(folder_.path("link"), "new");
  store(folder_.path("dangling"), "made");
  EXPECT_TRUE(fs::is_symlink(folder_.path("link")));
  EXPECT_EQ(readBytes(folder_.path("real")), "new");
  EXPECT_TRUE(fs::is_symlink(folder_.path("dangling")));
  EXPECT_EQ(readBytes(folder_.path("absent")), "made");
  fs::create_symlink("circle", folder_.path("circle"));
  EXPECT_NE(messageOf<FileError>([&] { OutputFile file(folder_.path("circle")); }), "");
}

TEST_F(OutputFileTest, WritesDevicesDirectly) {
  store("/dev/null", "text");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  checkWritable("/dev/null");
}

TEST_F(OutputFileTest, ReportsAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_EQ(messageOf<FileError>([] { store("/dev/full", "text"); }),
            "/dev/full: cannot be written: No space left on device");
  EXPECT_EQ(messageOf<FileError>([] { OutputFile("/dev/full").write(std::string(1'000'000, 'x')); }),
            "/dev/full: cannot be written: No space left on device");
}

TEST_F(OutputFileTest, SaysWhyATargetCannotBeWritten) {
  const std::string nowhere = folder_.path("no/where");
  const std::string expected = nowhere + ": cannot be written: there is no folder '" + folder_.path("no") + "'";
  EXPECT_EQ(messageOf<FileError>([&] { OutputFile file(nowhere); }), expected);
  EXPECT_EQ(messageOf<FileError>([&] { checkWritable(nowhere); }), expected);
  const std::string folder = folder_.path("");
  EXPECT_EQ(messageOf<FileError>([&] { checkWritable(folder); }), folder + ": cannot be written: it is a directory");
  EXPECT_EQ(messageOf<FileError>([&] { checkWritable(""); }), "the path of the file to write is empty");
  EXPECT_EQ(messageOf<FileError>([&] { checkWritable(folder_.path("new/")); }),
            folder_.path("new/") + ": cannot be written: it names a directory that does not exist");
}

TEST_F(OutputFileTest, RefusesWriteProtectedTargets) {
  if (::geteuid() == 0) GTEST_SKIP() << "nothing is write-protected for root";
  const std::string path = folder_.path("out");
  writeBytes(path, "old");
  ASSERT_EQ(::chmod(path.c_str(), 0444), 0);
  EXPECT_EQ(messageOf<FileError>([&] { checkWritable(path); }), path + ": cannot be written: Permission denied");
}

TEST_F(OutputFileTest, CheckingLeavesNoTrace) {
  writeBytes(folder_.path("old"), "old");
  checkWritable(folder_.path("old"));
  checkWritable(folder_.path("new"));
  checkWritable("-");
  EXPECT_EQ(readBytes(folder_.path("old")), "old");
  EXPECT_EQ(folder_.fileCount(), 1U);
}

TEST_F(OutputFileTest, RefusesUseAfterCommit) {
  OutputFile file(folder_.path("out"));
  file.commit();
  EXPECT_THROW(file.write("x"), LogicError);
  EXPECT_THROW(file.commit(), LogicError);
}

}  // namespace
}  // namespace quiver
