// Every way a .g2o file can be wrong, with the message that says so.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/util/error.h>
#include <tests/io/graph_types.h>
#include <tests/io/temporary_folder.h>

namespace quiver {
namespace {

struct Malformed {
  const char* name;
  std::string text;
  std::string message;
};

void PrintTo(const Malformed& malformed, std::ostream* out) { *out << malformed.name; }

std::string readError(const std::string& text, const ReadOptions& options = {}) {
  return test::messageOf<ParseError>([&] { readGraphText(text, "a.g2o", test::makeRegistry(), options); });
}

const std::string poses = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0.5\n";
const std::string point = "VERTEX_XY 7 1 2\n";
const std::string edge = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n";

std::vector<Malformed> tagsAndIds() {
  const std::string binary("VERTEX_SE2 0 0 0\0 0\n", 20);
  return {
      {"UnknownTag", poses + "EDGE_SE3 0 1 2\n", "a.g2o:3:1: unknown tag 'EDGE_SE3', did you mean 'EDGE_SE2'?"},
      {"TagFarFromAny", "  something else\n", "a.g2o:1:3: unknown tag 'something'"},
      {"ShortTagFarFromAny", "FOO 1\n", "a.g2o:1:1: unknown tag 'FOO'"},
      {"LowerCaseTag", "vertex_se2 0 0 0 0\n", "a.g2o:1:1: unknown tag 'vertex_se2', did you mean 'VERTEX_SE2'?"},
      {"NoId", "VERTEX_SE2\n", "a.g2o:1:11: the line ends early: the id of 'VERTEX_SE2' is missing"},
      {"IdIsAWord", "VERTEX_SE2 first 0 0 0\n", "a.g2o:1:12: 'first' is not an integer"},
      {"IdHasDecimals", "VERTEX_SE2 1.0 0 0 0\n", "a.g2o:1:12: '1.0' is not an integer"},
      {"IdIsHuge", "VERTEX_SE2 9223372036854775808 0 0 0\n",
       "a.g2o:1:12: '9223372036854775808' is too large for a 64-bit integer"},
      {"IdIsNegative", "VERTEX_SE2 -1 0 0 0\n", "a.g2o:1:12: vertex id -1 is negative; ids are 0 or more"},
      {"EdgeIdIsUnset", poses + "EDGE_SE2 0 -1 1 0 0 1 0 0 1 0 1\n",
       "a.g2o:3:12: vertex id -1 is negative; ids are 0 or more"},
      {"VertexTwice", poses + "VERTEX_SE2 0 5 5 5\n", "a.g2o:3:12: vertex 0 exists already, since line 1"},
      {"VertexTwiceByOtherTypes", poses + "VERTEX_XY 1 5 5\n", "a.g2o:3:11: vertex 1 exists already, since line 2"},
      {"VertexTwiceWithoutEstimate", poses + "#quiver vertex VERTEX_SE2 1\n",
       "a.g2o:3:27: vertex 1 exists already, since line 2"},
      {"ParameterTwice", "PARAMS_SCALE 0 1\nPARAMS_SE2OFFSET 0 0 0 0\n",
       "a.g2o:2:18: parameter 0 exists already, since line 1"},
      {"ParameterIdIsNegative", "PARAMS_SCALE -3 1\n", "a.g2o:1:14: parameter id -3 is negative; ids are 0 or more"},
      {"EdgeToNowhere", poses + "EDGE_SE2 0 2 1 0 0 1 0 0 1 0 1\n",
       "a.g2o:3:12: EDGE_SE2 names vertex 2, which is not in the file"},
      {"EdgeWithOneVertexTwice", poses + "EDGE_SE2 1 1 1 0 0 1 0 0 1 0 1\n",
       "a.g2o:3:12: EDGE_SE2 names vertex 1 twice"},
      {"EdgeWithOneIdOnly", poses + "EDGE_SE2 0\n", "a.g2o:3:11: the line ends early: EDGE_SE2 joins 2 vertices"},
      {"WrongVertexType", poses + "EDGE_SE2_XY 0 1 1 0 1 0 1\n",
       "a.g2o:3:15: edge EDGE_SE2_XY wants a VERTEX_XY at place 2, but vertex 1 is a VERTEX_SE2"},
      {"MissingParameter", poses + point + "EDGE_SE2_POINTXY_OFFSET 0 7 4 1 0 1 0 1\n",
       "a.g2o:4:29: EDGE_SE2_POINTXY_OFFSET names parameter 4, which is not in the file"},
      {"NoParameterId", poses + point + "EDGE_SE2_POINTXY_OFFSET 0 7\n",
       "a.g2o:4:28: the line ends early: EDGE_SE2_POINTXY_OFFSET names 1 parameter"},
      {"WrongParameterType", poses + point + "PARAMS_SCALE 4 1\nEDGE_SE2_POINTXY_OFFSET 0 7 4 1 0 1 0 1\n",
       "a.g2o:5:29: edge EDGE_SE2_POINTXY_OFFSET wants a PARAMS_SE2OFFSET, but parameter 4 is a PARAMS_SCALE"},
      {"FixOfNothing", poses + "FIX\n", "a.g2o:3:4: the line ends early: FIX names at least one vertex"},
      {"FixOfAMissingVertex", poses + "FIX 0 3\n", "a.g2o:3:7: FIX names vertex 3, which is not in the file"},
      {"FixOfAWord", poses + "FIX all\n", "a.g2o:3:5: 'all' is not an integer"},
      {"BarsAreMissing", poses + point + "EDGE_SE2_LOTSOFXY 0 7\n",
       "a.g2o:4:22: the line ends early: '||' ends the vertices of EDGE_SE2_LOTSOFXY"},
      {"BarsAreEarly", poses + point + "EDGE_SE2_LOTSOFXY 0 || 1\n", "a.g2o:4:21: '||' is not an integer"},
      {"BinaryData", binary, "a.g2o:1:17: byte 0x00 has no place in a text file"},
      {"BinaryTag",
       "\x7f"
       "ELF\x02\x01\n",
       "a.g2o:1:1: byte 0x7f has no place in a text file"},
      {"BinaryComment", "# \x1b[0m\n" + poses, "a.g2o:1:3: byte 0x1b has no place in a text file"},
      {"BinaryDataLine", poses + "ROBOTLASER1 \x01\n", "a.g2o:3:13: byte 0x01 has no place in a text file"},
      {"LineOfAMegabyte", poses + std::string(1 << 20, 'A') + "\n",
       "a.g2o:3:1: unknown tag 'AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA…'"},
      {"LongTagIsNotCutInACharacter",
       std::string(39, 'A') + "\xc3\xa4"
                              "BC\n",
       "a.g2o:1:1: unknown tag '" + std::string(39, 'A') + "…'"},
  };
}

std::string numberList(int first, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += " " + std::to_string(first + i);
  return text;
}

std::vector<Malformed> fieldsAndNumbers() {
  const std::string numbers = [] {
    std::string text;
    for (int i = 0; i < 200'000; ++i) text += " 1.5";
    return text;
  }();
  return {
      {"ShortVertex", "VERTEX_SE2 0 0 0\n", "a.g2o:1:17: the line ends early: field 'theta' of VERTEX_SE2 is missing"},
      {"ShortVertexWithBlanks", "VERTEX_SE2 0 0 0 \t\r\n",
       "a.g2o:1:17: the line ends early: field 'theta' of VERTEX_SE2 is missing"},
      {"ShortLastLine", "VERTEX_SE2 0", "a.g2o:1:13: the line ends early: field 'x' of VERTEX_SE2 is missing"},
      {"ShortEdge", poses + "EDGE_SE2 0 1 1\n", "a.g2o:3:15: the line ends early: field 'y' of EDGE_SE2 is missing"},
      {"NoInformation", poses + "EDGE_SE2 0 1 1 0 0\n",
       "a.g2o:3:19: the line ends early: entry (1, 1) of the information matrix is missing"},
      {"ShortInformation", poses + "EDGE_SE2 0 1 1 0 0 1 0 0 1\n",
       "a.g2o:3:27: the line ends early: entry (2, 3) of the information matrix is missing"},
      {"ShortParameter", "PARAMS_SE2OFFSET 0 1 2\n" + poses,
       "a.g2o:1:23: the line ends early: field 'theta' of PARAMS_SE2OFFSET is missing"},
      {"ExtraToken", "VERTEX_SE2 0 0 0 0 17\n", "a.g2o:1:20: unexpected '17' after the last field of VERTEX_SE2"},
      {"ExtraTokenAfterInformation", poses + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1 # loop\n",
       "a.g2o:3:32: unexpected '#' after the last field of EDGE_SE2"},
      {"MegabyteOfExtraNumbers", "VERTEX_SE2 0 0 0 0" + numbers + "\n",
       "a.g2o:1:20: unexpected '1.5' after the last field of VERTEX_SE2"},
      {"NotANumber", "VERTEX_SE2 0 0 zero 0\n", "a.g2o:1:16: 'zero' is not a number"},
      {"NumberWithATail", "VERTEX_SE2 0 0 1.5m 0\n", "a.g2o:1:16: '1.5m' is not a number"},
      {"TwoPoints", "VERTEX_SE2 0 0 1.2.3 0\n", "a.g2o:1:16: '1.2.3' is not a number"},
      {"DecimalComma", "VERTEX_SE2 0 0 1,5 0\n", "a.g2o:1:16: '1,5' is not a number; decimals follow a point"},
      {"Hexadecimal", "VERTEX_SE2 0 0 0x10 0\n", "a.g2o:1:16: '0x10' is not a number"},
      {"Nan", "VERTEX_SE2 0 nan 0 0\n", "a.g2o:1:14: 'nan' is not a finite number"},
      {"NegativeNan", "VERTEX_SE2 0 -nan 0 0\n", "a.g2o:1:14: '-nan' is not a finite number"},
      {"Infinity", "VERTEX_SE2 0 0 0 -inf\n", "a.g2o:1:18: '-inf' is not a finite number"},
      {"NanInInformation", poses + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 nan\n", "a.g2o:3:30: 'nan' is not a finite number"},
      {"Overflow", "VERTEX_SE2 0 1e400 0 0\n", "a.g2o:1:14: '1e400' is too large for a double"},
      {"OverflowOfDigits", "VERTEX_SE2 0 " + std::string(400, '9') + " 0 0\n",
       "a.g2o:1:14: '" + std::string(40, '9') + "…' is too large for a double"},
      {"ZeroQuaternion", "VERTEX_SE3:QUAT 0 1 2 3 0 0 0 0\n",
       "a.g2o:1:31: a quaternion of norm below 1e-6 is no rotation"},
      {"LongQuaternion", "VERTEX_SE3:QUAT 0 1 2 3 1e200 0 0 1e200\n",
       "a.g2o:1:35: a quaternion this long is no rotation"},
      {"WrongCount", poses + point + "EDGE_SE2_LOTSOFXY 0 7 || 2 1 2 1 0 1\n",
       "a.g2o:4:26: the number of points is not that of the vertices"},
      {"HugeCount", poses + point + "EDGE_SE2_LOTSOFXY 0 7 || 4611686018427387904 1 2 1 0 1\n",
       "a.g2o:4:26: the number of points is not that of the vertices"},
      {"ShortVariableEdge", poses + point + "EDGE_SE2_LOTSOFXY 0 7 || 1 1 2 1 0\n",
       "a.g2o:4:35: the line ends early: entry (2, 2) of the information matrix is missing"},
      {"NegativeRange", poses + "BR 0 7 0.3 -2 0.1 0.5\n", "a.g2o:3:12: a range is positive"},
      {"NoDeviation", poses + "BR 0 7 0.3 2 0 0.5\n", "a.g2o:3:14: a standard deviation is positive"},
      {"ManyVerticesWithoutInformation", "EDGE_SE2_LOTSOFXY 0" + numberList(1, 2000) + " || 2000 1 2\n",
       "a.g2o:1:8925: the line ends early: the information matrix for 2001 vertices is missing"},
      {"EmptyFile", "", "a.g2o: the file holds no vertex and no edge"},
      {"OnlyBlanksAndComments", "\n \t\r\n# nothing\n", "a.g2o: the file holds no vertex and no edge"},
      {"OnlyParameters", "PARAMS_SCALE 0 1\n", "a.g2o: the file holds no vertex and no edge"},
      {"ByteOrderMarkOfUtf16", std::string("\xff\xfeV\0E\0", 6), "a.g2o:1:4: byte 0x00 has no place in a text file"},
  };
}

std::vector<Malformed> informationMatrices() {
  return {
      {"NegativeInformation", poses + "EDGE_SE2 0 1 1 0 0 -1 0 0 1 0 1\n",
       "a.g2o:3:20: information matrix is not positive semi-definite: its eigenvalues reach from -1 to 1 (the only "
       "such line)"},
      {"IndefiniteInformation", poses + "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n",
       "a.g2o:3:20: information matrix is not positive semi-definite: its eigenvalues reach from -1 to 3 (the only "
       "such line)"},
      {"NegativeDefiniteInformation", poses + "EDGE_SE2 0 1 1 0 0 -1 0 0 -2 0 -3\n",
       "a.g2o:3:20: information matrix is not positive semi-definite: its eigenvalues reach from -3 to -1 (the only "
       "such line)"},
      {"ManyIndefiniteMatrices",
       poses + "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n" + edge + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 -5\n",
       "a.g2o:3:20: information matrix is not positive semi-definite: its eigenvalues reach from -1 to 3 (the first of "
       "2 such "
       "lines)"},
  };
}

std::vector<Malformed> directives() {
  return {
      {"UnknownDirective", poses + "#quiver colour red\n",
       "a.g2o:3:9: unknown #quiver line 'colour': known are kernel, level, fixed and vertex"},
      {"EmptyDirective", poses + "#quiver\n",
       "a.g2o:3:8: the line ends early: '#quiver' is followed by kernel, level, fixed or vertex"},
      {"KernelWithoutEdge", poses + "#quiver kernel Huber 1\n", "a.g2o:3:16: '#quiver kernel' stands after an edge"},
      {"UnknownKernel", poses + edge + "#quiver kernel Hubert 1\n",
       "a.g2o:4:16: unknown robust kernel 'Hubert', did you mean 'Huber'?"},
      {"KernelWithoutWidth", poses + edge + "#quiver kernel Huber\n",
       "a.g2o:4:21: the line ends early: the kernel's width is missing"},
      {"KernelOfNoWidth", poses + edge + "#quiver kernel Huber 0\n", "a.g2o:4:22: a kernel's width is positive"},
      {"KernelAndMore", poses + edge + "#quiver kernel Shaped 1 2 3\n",
       "a.g2o:4:27: unexpected '3' at the end of a #quiver line"},
      {"LevelWithoutNumber", poses + edge + "#quiver level\n", "a.g2o:4:14: the line ends early: a level is missing"},
      {"LevelIsHuge", poses + edge + "#quiver level 2147483648\n",
       "a.g2o:4:15: a level is a number from -2147483648 to 2147483647"},
      {"FixedDirectionOfAnEdge", poses + edge + "#quiver fixed 0\n",
       "a.g2o:4:14: '#quiver fixed' stands after a vertex"},
      {"FixedDirectionIsNone", poses + "#quiver fixed 3\n",
       "a.g2o:3:15: a direction of this vertex is a number from 0 to 2"},
      {"BlankVertexWithoutTag", "#quiver vertex\n",
       "a.g2o:1:15: the line ends early: '#quiver vertex' is followed by a tag and an id"},
      {"BlankVertexOfAnEdge", "#quiver vertex EDGE_SE2 0\n", "a.g2o:1:16: 'EDGE_SE2' is no vertex type"},
      {"BlankVertexWithValues", "#quiver vertex VERTEX_SE2 0 1 2 3\n",
       "a.g2o:1:29: unexpected '1' after the last field of VERTEX_SE2"},
  };
}

std::vector<Malformed> all() {
  std::vector<Malformed> result = tagsAndIds();
  for (const auto& part : {fieldsAndNumbers(), informationMatrices(), directives()}) {
    result.insert(result.end(), part.begin(), part.end());
  }
  return result;
}

class MalformedFile : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedFile, IsRefusedWithAMessage) { EXPECT_EQ(readError(GetParam().text), GetParam().message); }

TEST_P(MalformedFile, IsRefusedAlikeWithAnotherEndOfLines) {
  if (GetParam().text.find('\r') != std::string::npos) return;  // has such ends already
  std::string text;
  for (const char c : GetParam().text) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(readError(text), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(Everything, MalformedFile, testing::ValuesIn(all()),
                         [](const auto& info) { return info.param.name; });

TEST(G2oErrors, TheFirstErrorOfTheFileIsReported) {
  const std::string bad = "VERTEX_SE2 0 0 nan 0\n";
  EXPECT_EQ(readError(bad + "EDGE_FOO 1\n"), "a.g2o:1:16: 'nan' is not a finite number");
  EXPECT_EQ(readError(bad + bad), "a.g2o:1:16: 'nan' is not a finite number");
  EXPECT_EQ(readError(poses + "EDGE_SE2 0 1 x 0 0 1 0 0 1 0 1\n" + poses), "a.g2o:3:14: 'x' is not a number");
  EXPECT_EQ(readError("EDGE_FOO 1\n" + bad), "a.g2o:1:1: unknown tag 'EDGE_FOO'");
}

TEST(G2oErrors, KindsOfErrorsComeInTheOrderOfTheDocument) {
  const std::string tag = "EDGE_FOO 1\n", twice = "VERTEX_SE2 1 0 0 0\n", nowhere = "EDGE_SE2 0 7 1 0 0 1 0 0 1 0 1\n",
                    information = "EDGE_SE2 0 1 1 0 0 1 0 0 -1 0 1\n", fix = "FIX 9\n";
  const std::vector<std::string> kinds{fix, information, nowhere, twice, tag};
  const std::vector<std::string> places{"a.g2o:3:5: ", "a.g2o:4:", "a.g2o:5:12: ", "a.g2o:6:12: ", "a.g2o:7:1: "};
  std::string text = poses;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    text += kinds[i];
    EXPECT_EQ(readError(text).rfind(places[i], 0), 0u) << readError(text);
  }
}

TEST(G2oErrors, IsTheSameForAnyNumberOfThreads) {
  std::string text;
  for (int i = 0; i < 60'000; ++i) {
    text += "VERTEX_SE2 " + std::to_string(i) + (i == 31'234 || i == 59'000 ? " 0 x 0\n" : " 0 0 0\n");
  }
  for (const int threads : {1, 2, 7})
    EXPECT_EQ(readError(text, {.threads = threads}), "a.g2o:31235:20: 'x' is not a number");
}

TEST(G2oErrors, CountsInformationMatricesOverAllChunks) {
  std::string text = poses;
  for (int i = 0; i < 20'000; ++i) text += i % 10 == 3 ? "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n" : edge;
  for (const int threads : {1, 2}) {
    EXPECT_EQ(readError(text, {.threads = threads}),
              "a.g2o:6:20: information matrix is not positive semi-definite: its eigenvalues reach from -1 to 3 (the "
              "first of "
              "2000 such lines)");
  }
}

TEST(G2oErrors, LinesThatWouldMakeAnotherFormatAreNotKept) {
  const ReadOptions keep{.unknown = UnknownTags::keep};
  EXPECT_EQ(readError(poses + ".5 and more\n", keep), "a.g2o:3:1: unknown tag '.5', which is none that can be kept");
  EXPECT_EQ(readError(poses + "a,b c\n", keep), "a.g2o:3:1: unknown tag 'a,b', which is none that can be kept");
  EXPECT_EQ(readError(poses + "a b,c\n", keep), "");
}

TEST(G2oErrors, NamesTheFile) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path("bad.g2o");
  test::writeBytes(path, "VERTEX_SE2 0 0 0\n");
  EXPECT_EQ(test::messageOf<ParseError>([&] { readGraph(path, test::makeRegistry()); }),
            path + ":1:17: the line ends early: field 'theta' of VERTEX_SE2 is missing");
  EXPECT_THROW(readGraph(folder.path("none.g2o"), test::makeRegistry()), FileError);
  EXPECT_THROW(readGraph(path, nullptr), GraphError);
}

}  // namespace
}  // namespace quiver
