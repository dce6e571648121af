// Ten ways and more to damage a compressed file, and the message that says so; damage of the text inside has a place.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <quiver/core/io/files/output_file.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>
#include <tests/io/temporary_folder.h>

namespace quiver {
namespace {

using test::messageOf;
using test::readBytes;
using test::writeBytes;

class MalformedArchive : public testing::Test {
 protected:
  std::string compressed(const std::string& name, const std::string& text) {
    OutputFile file(folder_.path(name));
    file.write(text);
    file.commit();
    return readBytes(folder_.path(name));
  }
  /// Without the path.
  std::string message(const std::string& bytes) {
    const std::string path = folder_.path("f");
    writeBytes(path, bytes);
    const std::string said = messageOf<ParseError>([&] { readGraph(path, builtinRegistry()); });
    EXPECT_EQ(said.rfind(path + ":", 0), 0U) << said;
    return said.substr(std::min(said.size(), path.size()));
  }
  static std::string with(std::string bytes, std::size_t place, int value) {
    bytes.at(place) = static_cast<char>(value);
    return bytes;
  }
  static std::string flipped(std::string bytes, std::size_t place) {
    bytes.at(place) = static_cast<char>(~bytes.at(place));
    return bytes;
  }

  const std::string text_ = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n";
  test::TemporaryFolder folder_;
};

TEST_F(MalformedArchive, Gzip) {
  const std::string good = compressed("a.gz", text_);
  const std::string corrupt = ": gzip data is corrupt", truncated = ": gzip data is truncated";
  EXPECT_EQ(message("\x1f\x8b"), truncated);
  EXPECT_EQ(message(good.substr(0, 9)), truncated);                // in the header
  EXPECT_EQ(message(good.substr(0, good.size() / 2)), truncated);  // in the data
  EXPECT_EQ(message(good.substr(0, good.size() - 8)), truncated);  // before the checksum
  EXPECT_EQ(message(good.substr(0, good.size() - 1)), truncated);  // in the length
  EXPECT_EQ(message(with(good, 2, 7)), corrupt);                   // an unknown method
  EXPECT_EQ(message(with(good, 3, 0xe0)), corrupt);                // reserved flags
  EXPECT_EQ(message(with(good, 10, 0x07)), corrupt);               // a block of the reserved kind
  EXPECT_EQ(message(flipped(good, good.size() - 8)), corrupt);     // another checksum
  EXPECT_EQ(message(flipped(good, good.size() - 4)), corrupt);     // another length
  EXPECT_EQ(message(good + "EDGE_SE2"), ": gzip data is followed by something else");
  EXPECT_EQ(message(good + good.substr(0, 12)), truncated);  // in the second member
  EXPECT_EQ(message(compressed("b.gz", text_ + "EDGE_SE2 0 1 x\n")), ":4:14: 'x' is not a number");
  EXPECT_EQ(message(compressed("c.gz", "")), ": the file holds no vertex and no edge");
}

TEST_F(MalformedArchive, Bzip2) {
  const std::string good = compressed("a.bz2", text_);
  const std::string corrupt = ": bzip2 data is corrupt", truncated = ": bzip2 data is truncated";
  EXPECT_EQ(message("BZh9"), truncated);
  EXPECT_EQ(message(good.substr(0, 8)), truncated);                // in the mark of a block
  EXPECT_EQ(message(good.substr(0, good.size() / 2)), truncated);  // in the data
  EXPECT_EQ(message(good.substr(0, good.size() - 4)), truncated);  // before the checksum
  EXPECT_EQ(message(good.substr(0, good.size() - 1)), truncated);  // in the checksum
  // What does not begin as bzip2 does, with the size and the mark of a block, is text.
  EXPECT_NE(message(with(good, 3, '0')).find("has no place in a text file"), std::string::npos);
  EXPECT_NE(message(flipped(good, 5)).find("has no place in a text file"), std::string::npos);
  EXPECT_EQ(message(flipped(good, 11)), corrupt);               // another checksum of the block
  EXPECT_EQ(message(flipped(good, good.size() / 2)), corrupt);  // other data
  EXPECT_EQ(message(flipped(good, good.size() - 3)), corrupt);  // another checksum of the file
  EXPECT_EQ(message(good + "EDGE_SE2"), ": bzip2 data is followed by something else");
  EXPECT_EQ(message(good + good.substr(0, 20)), truncated);  // in the second stream
  EXPECT_EQ(message(compressed("b.bz2", text_ + "EDGE_SE2 0 1 x\n")), ":4:14: 'x' is not a number");
  EXPECT_EQ(message(compressed("c.bz2", "")), ": the file holds no vertex and no edge");
}

}  // namespace
}  // namespace quiver
