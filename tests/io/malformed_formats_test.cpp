// Every way a TORO file or a table can be wrong, with the message that says so.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>
#include <tests/io/temporary_folder.h>

namespace quiver {
namespace {

struct Malformed {
  const char* name;
  std::string text;
  std::string message;
};
void PrintTo(const Malformed& malformed, std::ostream* out) { *out << malformed.name; }

std::vector<Malformed> planarToro() {
  const std::string poses = "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0.5\n";
  return {
      {"ToroVertexIsShort", "VERTEX2 0 0 0\n", "f:1:14: the line ends early: field 'theta' of VERTEX2 is missing"},
      {"ToroIdIsMissing", "VERTEX2\n", "f:1:8: the line ends early: the id of 'VERTEX2' is missing"},
      {"ToroVertexTwice", poses + "VERTEX2 1 0 0 0\n", "f:3:9: vertex 1 exists already, since line 2"},
      {"ToroVertexByBothNames", poses + "VERTEX_SE2 1 0 0 0\n", "f:3:12: vertex 1 exists already, since line 2"},
      {"ToroEdgeToNowhere", poses + "EDGE2 0 5 1 0 0 1 0 1 1 0 0\n",
       "f:3:9: EDGE2 names vertex 5, which is not in the file"},
      {"ToroEdgeIsALoop", poses + "EDGE2 1 1 1 0 0 1 0 1 1 0 0\n", "f:3:9: EDGE2 names vertex 1 twice"},
      {"ToroInformationIsShort", poses + "EDGE2 0 1 1 0 0 1 0 1 1 0\n",
       "f:3:26: the line ends early: entry (3, 3) of the information matrix is missing"},
      {"ToroInformationIsLong", poses + "EDGE2 0 1 1 0 0 1 0 1 1 0 0 7\n",
       "f:3:29: unexpected '7' after the last field of EDGE2"},
      // I33 comes fourth here, where .g2o has I22.
      {"ToroInformationIsNegative", poses + "EDGE2 0 1 1 0 0 1 0 1 -2 0 0\n",
       "f:3:17: information matrix is not positive semi-definite: its eigenvalues reach from -2 to 1 (the only such "
       "line)"},
      {"ToroInformationIsNan", poses + "EDGE2 0 1 1 0 0 1 0 1 nan 0 0\n", "f:3:23: 'nan' is not a finite number"},
      {"ToroTagIsMisspelt", poses + "EDGE22 0 1 1 0 0 1 0 1 1 0 0\n",
       "f:3:1: unknown tag 'EDGE22', did you mean 'EDGE2'?"},
      {"ToroLandmarkIsAPose", poses + "BR 0 1 0.3 2 0.1 0.5\n",
       "f:3:6: edge EDGE_SE2_XY wants a VERTEX_XY at place 2, but vertex 1 is a VERTEX_SE2"},
      {"ToroBearingWithoutRange", poses + "BR 0 7 0.3\n", "f:3:11: the line ends early: field 'y' of BR is missing"},
      {"ToroBearingIsShort", poses + "BR 0 7 0.3 2 0.1\n", "f:3:17: the line ends early: BR has further fields"},
  };
}

std::vector<Malformed> spatialToro() {
  const std::string poses = "VERTEX3 0 0 0 0 0 0 0\nVERTEX3 1 1 0 0 0 0 0.5\n";
  const std::string ones = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";
  const std::string edge = "EDGE3 0 1 1 0 0 0 0 0.5" + ones;
  return {
      {"SpatialVertexIsShort", "VERTEX3 0 1 2 3 0.1 0.2\n",
       "f:1:24: the line ends early: field 'yaw' of VERTEX3 is missing"},
      {"SpatialVertexIsLong", "VERTEX3 0 0 0 0 0 0 0 1\n", "f:1:23: unexpected '1' after the last field of VERTEX3"},
      {"SpatialAngleIsAWord", "VERTEX3 0 0 0 0 0 up 0\n", "f:1:19: 'up' is not a number"},
      {"SpatialIdIsNegative", "VERTEX3 -4 0 0 0 0 0 0\n", "f:1:9: vertex id -4 is negative; ids are 0 or more"},
      {"SpatialVertexTwice", poses + "VERTEX3 0 0 0 0 0 0 0\n", "f:3:9: vertex 0 exists already, since line 1"},
      {"SpatialEdgeToNowhere", poses + "EDGE3 0 9 1 0 0 0 0 0.5" + ones,
       "f:3:9: EDGE3 names vertex 9, which is not in the file"},
      {"SpatialEdgeIsALoop", poses + "EDGE3 1 1 1 0 0 0 0 0.5" + ones, "f:3:9: EDGE3 names vertex 1 twice"},
      {"SpatialEdgeInThePlane", poses + "VERTEX2 2 0 0 0\nEDGE3 0 2 1 0 0 0 0 0.5" + ones,
       "f:4:9: edge EDGE3 wants a VERTEX3 at place 2, but vertex 2 is a VERTEX_SE2"},
      {"SpatialInformationIsShort", poses + edge.substr(0, edge.size() - 3) + "\n",
       "f:3:64: the line ends early: field 'I66' of EDGE3 is missing"},
      {"SpatialInformationIsInfinite", poses + "EDGE3 0 1 1 0 0 0 0 0.5 inf" + ones.substr(2),
       "f:3:25: 'inf' is not a finite number"},
      {"SpatialInformationIsNegative", poses + edge + "EDGE3 0 1 1 0 0 0 0 0 -1" + ones.substr(2),
       "f:4:10: information matrix is not positive semi-definite: its eigenvalues reach from -1 to 4 (the only such "
       "line)"},
      {"SpatialYawIsHalfATurn", poses + "EDGE3 0 1 1 0 0 0 0 3.141592653589793" + ones,
       "f:3:79: the angles' information cannot be mapped to the quaternion's for half a turn"},
  };
}

std::vector<Malformed> tables() {
  const std::string poses = "tag,id,x,y,theta\nVERTEX_SE2,0,0,0,0\nVERTEX_SE2,1,1,0,0.5\n";
  return {
      {"TableOfHeadings", "tag,id,x,y,theta\n", "f: the file holds no vertex and no edge"},
      {"EmptyCell", poses + "VERTEX_SE2,2,,0,0\n", "f:4:14: an empty cell before others"},
      {"CommaIsLost", poses + "VERTEX_SE2,2,0,0 1,0\n", "f:4:17: a blank inside a cell; is a comma missing?"},
      {"FirstCommaIsLost", poses + "VERTEX_SE2 2,0,1,0\n", "f:4:11: a blank inside a cell; is a comma missing?"},
      {"CommaIsLostInQuotes", poses + "VERTEX_SE2,2,\" 0\t1\",0\n",
       "f:4:17: a blank inside a cell; is a comma missing?"},
      {"EmptyTag", poses + ",2,0,0,0\n", "f:4:1: an empty cell before others"},
      {"OpenQuote", poses + "VERTEX_SE2,2,\"0,0,0\n", "f:4:14: this quote does not end on its line"},
      {"TextBehindAQuote", poses + "VERTEX_SE2,2,\"0\"1,0,0\n", "f:4:17: a comma follows a cell in quotes"},
      {"RowIsShort", poses + "VERTEX_SE2,2,0,0\n",
       "f:4:17: the line ends early: field 'theta' of VERTEX_SE2 is missing"},
      {"PaddedRowIsShort", poses + "VERTEX_SE2,2,0,0,,,\n",
       "f:4:17: the line ends early: field 'theta' of VERTEX_SE2 is missing"},
      {"RowIsLong", poses + "VERTEX_SE2,2,0,0,0,7\n", "f:4:20: unexpected '7' after the last field of VERTEX_SE2"},
      {"DecimalCommasInATable", poses + "VERTEX_SE2,2,1,5,2,5,0\n",
       "f:4:20: unexpected '5' after the last field of VERTEX_SE2"},
      {"CellIsAWord", poses + "VERTEX_SE2,2,east,0,0\n", "f:4:14: 'east' is not a number"},
      {"QuotedCellIsAWord", poses + "VERTEX_SE2,2,\"east\",0,0\n", "f:4:15: 'east' is not a number"},
      {"CellIsNan", poses + "VERTEX_SE2,2,0,nan,0\n", "f:4:16: 'nan' is not a finite number"},
      {"NegativeIdInATable", poses + "VERTEX_SE2,-2,0,0,0\n", "f:4:12: vertex id -2 is negative; ids are 0 or more"},
      {"UnknownTagInATable", poses + "VERTEX_SE3,2,0,0,0\n",
       "f:4:1: unknown tag 'VERTEX_SE3', did you mean 'VERTEX_SE2'?"},
      {"EdgeToNowhereInATable", poses + "EDGE_SE2,0,7,1,0,0,1,0,0,1,0,1\n",
       "f:4:12: EDGE_SE2 names vertex 7, which is not in the file"},
      {"SemicolonsDivideATable", "VERTEX_SE2;0;0;0;0\n", "f:1:1: unknown tag 'VERTEX_SE2;0;0;0;0'"},
  };
}

std::vector<Malformed> all() {
  std::vector<Malformed> result;
  for (const auto& part : {planarToro(), spatialToro(), tables()})
    result.insert(result.end(), part.begin(), part.end());
  return result;
}

class MalformedFormat : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedFormat, IsRefusedByPlace) {
  const std::string message =
      test::messageOf<ParseError>([&] { readGraphText(GetParam().text, "f", builtinRegistry()); });
  EXPECT_EQ(message, GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(All, MalformedFormat, testing::ValuesIn(all()),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace quiver
