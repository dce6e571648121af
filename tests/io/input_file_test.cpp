#include <random>
#include <string>

#include <gtest/gtest.h>

#include <quiver/core/io/files/input_file.h>
#include <quiver/core/io/files/output_file.h>
#include <quiver/core/util/error.h>
#include <tests/io/temporary_folder.h>

namespace quiver {
namespace {

using test::messageOf;
using test::readBytes;
using test::writeBytes;

std::string longText() {
  std::mt19937_64 random(6);
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += "VERTEX_XY " + std::to_string(random() % 1000) + "\n";
  return text;
}

class InputFileTest : public testing::Test {
 protected:
  std::string store(const std::string& name, const std::string& text) {
    const std::string path = folder_.path(name);
    OutputFile file(path);
    file.write(text);
    file.commit();
    return path;
  }

  test::TemporaryFolder folder_;
};

TEST_F(InputFileTest, MapsAPlainFile) {
  for (const std::size_t size : {1UL, 4095UL, 4096UL, 4097UL}) {
    const std::string text(size, 'x');
    writeBytes(folder_.path("plain"), text);
    const InputFile file(folder_.path("plain"));
    EXPECT_EQ(file.text(), text);
    EXPECT_EQ(file.storedBytes(), static_cast<std::int64_t>(size));
    EXPECT_EQ(file.name(), folder_.path("plain"));
  }
}

TEST_F(InputFileTest, ReadsAnEmptyFile) {
  writeBytes(folder_.path("empty"), "");
  EXPECT_EQ(InputFile(folder_.path("empty")).text(), "");
}

TEST_F(InputFileTest, ReadsADeviceAndAFileWithoutSize) {
  EXPECT_EQ(InputFile("/dev/null").text(), "");
  EXPECT_FALSE(InputFile("/proc/self/status").text().empty());
}

TEST_F(InputFileTest, MovesWithoutMovingTheText) {
  writeBytes(folder_.path("plain"), "abc");
  InputFile first(folder_.path("plain"));
  const char* data = first.text().data();
  InputFile second(std::move(first));
  EXPECT_EQ(second.text().data(), data);
  InputFile third("/dev/null");
  third = std::move(second);
  EXPECT_EQ(third.text(), "abc");
  EXPECT_EQ(second.text(), "");
}

TEST_F(InputFileTest, InflatesByContentNotByName) {
  const std::string text = longText();
  for (const char* name : {"a.gz", "a.bz2"}) {
    const std::string path = store(name, text);
    const std::string bytes = readBytes(path);
    EXPECT_LT(bytes.size(), text.size() / 2);
    const InputFile file(path);
    EXPECT_EQ(file.text(), text);
    EXPECT_EQ(file.storedBytes(), static_cast<std::int64_t>(bytes.size()));
    writeBytes(folder_.path("renamed.g2o"), bytes);
    EXPECT_EQ(InputFile(folder_.path("renamed.g2o")).text(), text);
  }
  writeBytes(folder_.path("plain.gz"), "VERTEX");
  EXPECT_EQ(InputFile(folder_.path("plain.gz")).text(), "VERTEX");
  writeBytes(folder_.path("text"), "BZh9 is how bzip2 begins");
  EXPECT_EQ(InputFile(folder_.path("text")).text(), "BZh9 is how bzip2 begins");
}

TEST_F(InputFileTest, InflatesAnEmptyText) {
  for (const char* name : {"a.gz", "a.bz2"}) EXPECT_EQ(InputFile(store(name, "")).text(), "");
}

TEST_F(InputFileTest, InflatesConcatenatedMembersAndPadding) {
  for (const char* name : {"a.gz", "a.bz2"}) {
    const std::string bytes = readBytes(store(name, "first\n"));
    writeBytes(folder_.path("twice"), bytes + bytes + std::string(512, '\0'));
    EXPECT_EQ(InputFile(folder_.path("twice")).text(), "first\nfirst\n");
  }
}

TEST_F(InputFileTest, RefusesTruncatedData) {
  const std::string text = longText();
  const std::string path = folder_.path("cut");
  for (const auto& [name, format] : {std::pair("a.gz", "gzip"), std::pair("a.bz2", "bzip2")}) {
    const std::string bytes = readBytes(store(name, text));
    for (const std::size_t size : {std::size_t{4}, std::size_t{11}, bytes.size() / 2, bytes.size() - 1}) {
      writeBytes(path, bytes.substr(0, size));
      EXPECT_EQ(messageOf<ParseError>([&] { InputFile file(path); }), path + ": " + format + " data is truncated")
          << size;
    }
  }
}

TEST_F(InputFileTest, RefusesCorruptData) {
  const std::string text = longText();
  const std::string path = folder_.path("corrupt");
  for (const auto& [name, format] : {std::pair("a.gz", "gzip"), std::pair("a.bz2", "bzip2")}) {
    std::string bytes = readBytes(store(name, text));
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
    writeBytes(path, bytes);
    EXPECT_EQ(messageOf<ParseError>([&] { InputFile file(path); }), path + ": " + format + " data is corrupt");
  }
}

TEST_F(InputFileTest, RefusesWhatFollowsCompressedData) {
  const std::string path = folder_.path("more");
  writeBytes(path, readBytes(store("a.gz", "text")) + "more");
  EXPECT_EQ(messageOf<ParseError>([&] { InputFile file(path); }), path + ": gzip data is followed by something else");
}

TEST_F(InputFileTest, LimitsWhatItInflates) {
  const std::string path = store("bomb.gz", std::string(10'000'000, '0'));
  EXPECT_EQ(messageOf<FileError>([&] { InputFile file(path, 1'000'000); }),
            path + ": inflates to more than 1000000 bytes");
}

TEST_F(InputFileTest, SaysWhyAFileCannotBeRead) {
  const std::string missing = folder_.path("missing");
  EXPECT_EQ(messageOf<FileError>([&] { InputFile file(missing); }), missing + ": no such file");
  EXPECT_EQ(messageOf<FileError>([&] { InputFile file(folder_.path("")); }),
            folder_.path("") + ": is a directory, not a file");
  EXPECT_EQ(messageOf<FileError>([&] { InputFile file(""); }), "the path of the file to read is empty");
  EXPECT_EQ(messageOf<FileError>([&] { InputFile file("/dev/null/x"); }),
            "/dev/null/x: cannot be read: Not a directory");
}

}  // namespace
}  // namespace quiver
