// TORO and tables, written and read.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include <quiver/core/io/files/graph_format.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_slam3d/addons/euler_conversion.h>
#include <tests/io/temporary_folder.h>

namespace quiver {
namespace {

Graph read(const std::string& text, ReadReport* report = nullptr) {
  return readGraphText(text, "f", builtinRegistry(), {.unknown = UnknownTags::keep, .threads = 1, .report = report});
}
std::string write(const Graph& graph, GraphFormat format) { return graphText(graph, {.threads = 1, .format = format}); }
std::string formatOf(const std::string& text) {
  ReadReport report;
  read(text, &report);
  return report.format;
}

/// Numbers of all lines, tags left out.
std::vector<double> numbersOf(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> numbers;
  for (std::string token; in >> token;) {
    if (token.find_first_not_of("+-.0123456789e") == std::string::npos) numbers.push_back(std::stod(token));
  }
  return numbers;
}

void expectAlike(const std::string& a, const std::string& b, double tolerance) {
  const std::vector<double> x = numbersOf(a), y = numbersOf(b);
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(y[i], x[i], tolerance * std::max(1.0, std::abs(x[i]))) << i;
}

const std::string planar =
    "# a plane\nVERTEX2 0 0 0 0\nROBOTLASER1 0 1 2\nFIX 0\nVERTEX2 1 1.5 -0.25 0.1\n"
    "EDGE2 0 1 1.5 -0.25 0.1 11 12 22 3300 13 23\n#quiver kernel Huber 2\n";

TEST(GraphFormats, AreToldByTheNameToWrite) {
  for (const char* path : {"a.graph", "a.toro", "x/a.graph.gz", "a.toro.bz2"})
    EXPECT_EQ(formatOfPath(path), GraphFormat::toro) << path;
  for (const char* path : {"a.csv", "a.csv.gz"}) EXPECT_EQ(formatOfPath(path), GraphFormat::csv) << path;
  for (const char* path : {"a.g2o", "a", "-", "", "graph", "a.csv.g2o"})
    EXPECT_EQ(formatOfPath(path), GraphFormat::g2o) << path;
}

TEST(GraphFormats, AreToldByTheTextToRead) {
  EXPECT_EQ(formatOf(planar), "toro");
  EXPECT_EQ(formatOf("VERTEX3 0 0 0 0 0 0 0\n"), "toro");
  EXPECT_EQ(formatOf("VERTEX_SE2 0 0 0 0\n"), "g2o");
  EXPECT_EQ(formatOf("VERTEX2 0 0 0 0\nVERTEX_SE2 1 0 0 0\n"), "g2o");
  EXPECT_EQ(formatOf("\xef\xbb\xbf# c, d\n\nVERTEX_SE2,0,0,0,0\n"), "csv");
  EXPECT_EQ(formatOf("\"VERTEX_SE2\",\"0\",\"0\",\"0\",\"0\"\n"), "csv");
}

TEST(Toro, PlanesRoundTripByteByByte) {
  EXPECT_EQ(write(read(planar), GraphFormat::toro), planar);
  // I11 I12 I22 I33 I13 I23 there, rows of the upper triangle here.
  EXPECT_NE(graphText(read(planar)).find("EDGE_SE2 0 1 1.5 -0.25 0.1 11 12 13 22 23 3300\n"), std::string::npos);
}

TEST(Toro, BearingsAndRangesRoundTrip) {
  const std::string text =
      "VERTEX2 0 0 0 0\n#quiver vertex VERTEX_XY 7\n#quiver vertex VERTEX_XY 8\nBR 0 7 0.3 2 0.0349 0.1\n"
      "BR 0 8 -3 17 0.2 0.5\n";
  const std::string written = write(read(text), GraphFormat::toro);
  EXPECT_NE(written.find("\nBR 0 8 "), std::string::npos);
  expectAlike(text, written, 1e-14);
  // Information that is not a bearing's and a range's.
  const Graph skewed = read("VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 1 0\nEDGE_SE2_XY 0 1 1 0 2 1 2\n");
  EXPECT_EQ(test::messageOf<GraphError>([&] { checkFormat(GraphFormat::toro, skewed); }),
            "TORO's BR cannot hold EDGE_SE2_XY 0 1: its information is not that of a bearing and a range");
}

TEST(Toro, RefusesOtherTypes) {
  const auto refusal = [](const std::string& text) {
    const Graph graph = read(text);
    return test::messageOf<GraphError>([&] { checkFormat("x.graph.gz", graph); });
  };
  EXPECT_EQ(refusal("VERTEX_PLANE 0 0 0 1 1 0 0 0\n"), "TORO files have no VERTEX_PLANE");
  EXPECT_EQ(refusal("PARAMS_SE2OFFSET 0 0 0 0\nVERTEX_SE2 0 0 0 0\n"), "TORO files have no PARAMS_SE2OFFSET");
  EXPECT_EQ(refusal("VERTEX_SE2 0 0 0 0\nEDGE_PRIOR_SE2_XY 0 0 0 1 0 1\n"), "TORO files have no EDGE_PRIOR_SE2_XY");
  EXPECT_EQ(refusal("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"),
            "TORO files have no VERTEX_SE3:QUAT; withEulerAngles() makes VERTEX3 and EDGE3 of such a graph");
  EXPECT_EQ(refusal(planar), "");
}

TEST(Toro, PosesInSpaceBecomeEulerAnglesAndBack) {
  const std::string text =
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 2 3 0.1 0.1 0.7 0.7\n#quiver fixed 0 2\n# between\n"
      "EDGE_SE3:QUAT 0 1 1 2 3 0.1 0.2 0.3 0.9273618495495703 100 1 2 3 4 5 110 6 7 8 9 120 10 11 12 1000 13 14 1100 "
      "15 1200\n#quiver kernel Cauchy 0.5\n#quiver level 3\nROBOTLASER1 0 data\n";
  const Graph graph = read(text);
  const Graph euler = withEulerAngles(graph);
  const std::string written = write(euler, GraphFormat::toro);
  EXPECT_EQ(written.rfind("VERTEX3 0 0 0 0 0 0 0\nVERTEX3 1 1 2 3 ", 0), 0U) << written;
  EXPECT_NE(written.find("#quiver fixed 0 2\n# between\nEDGE3 0 1 1 2 3 "), std::string::npos) << written;
  EXPECT_NE(written.find("#quiver kernel Cauchy 0.5\n#quiver level 3\nROBOTLASER1 0 data\n"), std::string::npos);
  // Information entries are sums of products up to 1e4.
  expectAlike(graphText(graph), graphText(withQuaternions(read(written))), 1e-12);
  EXPECT_EQ(test::messageOf<GraphError>([&] {
              withEulerAngles(
                  read("PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 4 0 0 0 0 0 0 1\n"
                       "EDGE_SE3_XYZ_PRIOR 4 0 0 0 0 1 0 0 1 0 1\n"));
            }),
            "EDGE_SE3_XYZ_PRIOR joins vertex 4 (VERTEX_SE3:QUAT), which is to become another type");
}

TEST(Csv, HoldsWhatG2oHolds) {
  const std::string text =
      "# at the top, with a comma\nPARAMS_SE2OFFSET 3 0.1 0 0\nVERTEX_SE2 0 0 0 0\nROBOTLASER1 0  1, \"two\"\nFIX 0\n"
      "VERTEX_SE2 1 1 0 0.5\n#quiver fixed 2\nVERTEX_XY 5 1 1\nUNKNOWN things\ntag\n"
      "EDGE_SE2 0 1 1 0 0.5 1 0 0 1 0 1\n#quiver level 2\nEDGE_SE2_LOTSOFXY 0 5 || 1 1 1 1 0 1\n"
      "EDGE_SE2_POINTXY_OFFSET 0 5 3 1 1 1 0 1\n";
  const Graph graph = read(text);
  const std::string table = write(graph, GraphFormat::csv);
  EXPECT_NE(table.find("\ntag,id,x,y,theta\nVERTEX_SE2,0,0,0,0\n\"ROBOTLASER1 0  1, \"\"two\"\"\"\nFIX,0\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("\ntag,id1,id2,x,y,theta,I11,I12,I13,I22,I23,I33\nEDGE_SE2,0,1,1,0,0.5,1,0,0,1,0,1\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("\ntag,id1,id2,parameter1,x,y,I11,I12,I22\n"), std::string::npos) << table;
  EXPECT_EQ(graphText(read(table)), graphText(graph));
  EXPECT_EQ(write(read(table), GraphFormat::csv), table);
}

TEST(Csv, ReadsWhatSpreadsheetsWrite) {
  const Graph graph = read(
      "\xef\xbb\xbftag,id,x,y,theta,,,,,,,\r\nVERTEX_SE2, 0 ,0,0,0,,,,,,,\r\n\"VERTEX_SE2\",\"1\",1,0,0.5,,,,,,,\r\n"
      "EDGE_SE2,0,1,1,0,0.5,1,0,0,1,0,1\r\n,,,,\r\n");
  EXPECT_EQ(graphText(graph), "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0.5\nEDGE_SE2 0 1 1 0 0.5 1 0 0 1 0 1\n");
}

TEST(Csv, BlanksEndCellsAndDivideLinesOfText) {
  const Graph graph = read(
      "tag, the id ,x of it,y,theta\nVERTEX_SE2, 0 ,\t0, \" 0 \" ,0 \nROBOTLASER1 1 2,,,\n# a, b c\nVERTEX_SE2 1 1 0 "
      "0\n");
  EXPECT_EQ(graphText(graph), "VERTEX_SE2 0 0 0 0\nROBOTLASER1 1 2\n# a, b c\nVERTEX_SE2 1 1 0 0\n");
}

}  // namespace
}  // namespace quiver
