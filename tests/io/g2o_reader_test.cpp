#include <bit>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/text/number_writer.h>
#include <quiver/core/util/error.h>
#include <tests/io/graph_types.h>

namespace quiver {
namespace {

using test::Odometry2;
using test::Panorama2;
using test::Point2;
using test::Pose2;
using test::Pose3;

Graph read(const std::string& text, const ReadOptions& options = {}) {
  return readGraphText(text, "a.g2o", test::makeRegistry(), options);
}

std::vector<const Edge*> edgesOf(const Graph& graph) {
  std::vector<const Edge*> edges;
  graph.forEachEdge([&](const Edge& edge) { edges.push_back(&edge); });
  return edges;
}

using Lines = std::vector<std::string>;

const std::string poses = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0.5\n";
const std::string edge = "EDGE_SE2 0 1 1 2 3 14 1 2 15 3 16\n";

TEST(G2oReader, ReadsVerticesAndEdges) {
  const Graph graph = read(poses + edge);
  EXPECT_EQ(graph.vertexCount(), 2);
  EXPECT_TRUE(graph.vertex<Pose2>(1).hasEstimate());
  EXPECT_EQ(graph.vertex<Pose2>(1).estimate().angle(), 0.5);
  const auto& odometry = static_cast<const Odometry2&>(*edgesOf(graph).at(0));
  EXPECT_EQ(odometry.vertexId(0), 0);
  EXPECT_EQ(odometry.vertexId(1), 1);
  EXPECT_EQ(odometry.measurement().translation()[1], 2.0);
  Matrix<double, 3, 3> information;
  information << 14, 1, 2, 1, 15, 3, 2, 3, 16;
  EXPECT_EQ(odometry.information(), information);
}

TEST(G2oReader, TakesLinesInAnyOrder) {
  const Graph graph = read("FIX 1\nEDGE_SE2_POINTXY_OFFSET 0 7 3 1 2 1 0 1\n" + edge + "VERTEX_XY 7 3 4\n" + poses +
                           "PARAMS_SE2OFFSET 3 1 2 3\n");
  EXPECT_EQ(graph.vertexCount(), 3);
  EXPECT_EQ(graph.edgeCount(), 2);
  EXPECT_EQ(graph.parameterCount(), 1);
  EXPECT_TRUE(graph.findVertex(1)->fixed());
  EXPECT_FALSE(graph.findVertex(0)->fixed());
}

TEST(G2oReader, TakesAnyBlanksAndEndsOfLines) {
  const Graph graph = read("\xef\xbb\xbf  VERTEX_SE2\t0 0   0 0 \r\n\n\r\n \t \nVERTEX_SE2 +1 +1 .5 5.e-1");
  EXPECT_EQ(graph.vertexCount(), 2);
  EXPECT_EQ(graph.vertex<Pose2>(1).estimate().translation()[1], 0.5);
}

TEST(G2oReader, KeepsIsolatedVerticesAndTheLargestId) {
  const Graph graph = read("VERTEX_XY 9223372036854775807 1 2\nVERTEX_XY 0 1e-400 -0\n");
  EXPECT_EQ(graph.vertexCount(), 2);
  EXPECT_EQ(graph.vertex<Point2>(9223372036854775807).estimate()[1], 2.0);
  EXPECT_EQ(graph.vertex<Point2>(0).estimate()[0], 0.0);
  EXPECT_TRUE(std::signbit(graph.vertex<Point2>(0).estimate()[1]));
}

TEST(G2oReader, FixesAllVerticesOfALine) {
  const Graph graph = read(poses + "VERTEX_XY 7 0 0\nFIX 0 7\n");
  EXPECT_TRUE(graph.findVertex(0)->fixed());
  EXPECT_FALSE(graph.findVertex(1)->fixed());
  EXPECT_TRUE(graph.findVertex(7)->fixed());
}

TEST(G2oReader, MakesVerticesOfAFileWithoutThem) {
  const Graph graph = read("EDGE_SE2_XY 5 2 1 0 1 0 1\nEDGE_SE2 5 9 1 2 3 1 0 0 1 0 1\nFIX 5\n");
  EXPECT_EQ(graph.vertexCount(), 3);
  EXPECT_FALSE(graph.vertex<Pose2>(5).hasEstimate());
  EXPECT_FALSE(graph.vertex<Pose2>(9).hasEstimate());
  EXPECT_FALSE(graph.vertex<Point2>(2).hasEstimate());
  EXPECT_TRUE(graph.findVertex(5)->fixed());
}

TEST(G2oReader, RefusesVerticesOfTwoTypesInAFileWithoutThem) {
  EXPECT_THROW(read("EDGE_SE2_XY 5 2 1 0 1 0 1\nEDGE_SE2 5 2 1 2 3 1 0 0 1 0 1\n"), ParseError);
}

TEST(G2oReader, ReadsIdsUntilTheBars) {
  const Graph graph = read(
      "VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 0 0\nVERTEX_POINT 2 0 0\n"
      "EDGE_SE2_LOTSOFXY 0 2 1 || 2 1 2 3 4 1 0 0 0 1 0 0 1 0 1\n");
  const auto& panorama = static_cast<const Panorama2&>(*edgesOf(graph).at(0));
  EXPECT_EQ(panorama.arity(), 3);
  EXPECT_EQ(panorama.vertexId(1), 2);
  EXPECT_EQ(panorama.measurement(), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(panorama.information().rows(), 4);
}

TEST(G2oReader, GivesCommentsToTheNextAndDataToTheLastElement) {
  const Graph graph = read(
      "# of the file\n\n#second\nVERTEX_SE2 0 0 0 0\nROBOTLASER1 1  2\t3  \r\n# between\nROBOTLASER1 4\n"
      "# of one\n#  \nFIX 0\nVERTEX_SE2 1 1 0 0.5\n" +
      edge + "# last");
  EXPECT_EQ(graph.fileAttachment().before, (Lines{"# of the file", "#second"}));
  EXPECT_EQ(graph.fileAttachment().after, (Lines{"# last"}));
  const Attachment* zero = graph.findAttachment(graph.findVertex(0));
  EXPECT_EQ(zero->before, Lines{});
  EXPECT_EQ(zero->after, (Lines{"ROBOTLASER1 1  2\t3", "# between", "ROBOTLASER1 4"}));
  const Attachment* one = graph.findAttachment(graph.findVertex(1));
  EXPECT_EQ(one->before, (Lines{"# of one", "#"}));
  EXPECT_EQ(one->after, Lines{});
}

TEST(G2oReader, ReadsWhatTheFormatCannotHold) {
  const Graph graph = read(poses + "#quiver fixed 2 0\n#quiver vertex VERTEX_XY 4\nFIX 4\n" + edge +
                           "#quiver kernel huber 1.5\n#quiver level -2\n" + edge + "#quiver kernel Shaped 2 3\n" +
                           edge + "#quiver kernel Shaped 2\n#quiverly a comment\n");
  EXPECT_EQ(graph.findVertex(1)->fixedDirections(), 5U);
  EXPECT_EQ(graph.findVertex(0)->fixedDirections(), 0U);
  EXPECT_FALSE(graph.vertex<Point2>(4).hasEstimate());
  EXPECT_TRUE(graph.findVertex(4)->fixed());
  const auto edges = edgesOf(graph);
  EXPECT_EQ(edges.at(0)->robustKernel().name(), "Huber");
  EXPECT_EQ(edges.at(0)->robustKernel().width(), 1.5);
  EXPECT_EQ(edges.at(0)->level(), -2);
  EXPECT_EQ(edges.at(1)->robustKernel().shape(), 3.0);
  EXPECT_EQ(edges.at(2)->robustKernel().shape(), 2.0);
  EXPECT_EQ(graph.fileAttachment().after, (Lines{"#quiverly a comment"}));
}

TEST(G2oReader, SkipsOrKeepsUnknownTags) {
  const std::string text = "HEADER 1\n" + poses + "VERTEX_FOO 3 4\nEDGE_FOO 0 3\n" + edge + "VERTEX_FOO 5\n";
  ReadReport report;
  const Graph skipped = read(text, {.unknown = UnknownTags::skip, .report = &report});
  const std::vector<std::pair<std::string, std::int64_t>> counts{{"HEADER", 1}, {"VERTEX_FOO", 2}, {"EDGE_FOO", 1}};
  EXPECT_EQ(report.unknownTags, counts);
  EXPECT_FALSE(skipped.hasAttachments());
  const Graph kept = read(text, {.unknown = UnknownTags::keep, .report = &report});
  EXPECT_EQ(report.unknownTags, counts);
  EXPECT_EQ(kept.fileAttachment().before, (Lines{"HEADER 1"}));
  EXPECT_EQ(kept.findAttachment(kept.findVertex(1))->after, (Lines{"VERTEX_FOO 3 4", "EDGE_FOO 0 3"}));
}

TEST(G2oReader, ClampsInformationOnRequest) {
  ReadReport report;
  const Graph graph = read(poses + edge + "EDGE_SE2 0 1 1 2 3 1 2 0 1 0 7\n",
                           {.information = InformationPolicy::clamp, .report = &report});
  EXPECT_EQ(report.clampedInformation, 1);
  const auto& odometry = static_cast<const Odometry2&>(*edgesOf(graph).at(1));
  Matrix<double, 3, 3> expected;
  expected << 1.5, 1.5, 0, 1.5, 1.5, 0, 0, 0, 7;
  EXPECT_LT((odometry.information() - expected).norm(), 1e-14);
}

TEST(G2oReader, AcceptsSingularInformation) {
  EXPECT_EQ(read(poses + "EDGE_SE2 0 1 1 2 3 0 0 0 0 0 0\nEDGE_SE2 0 1 1 2 3 1 1 0 1 0 -1e-7\n").edgeCount(), 2);
}

TEST(G2oReader, TellsRepeatedInformationFromItsLike) {
  const std::string ids = "EDGE_SE2 0 1 1 2 3 ";
  const std::string toro = "EDGE2 0 1 1 2 3 ";
  const Graph graph =
      read(poses + ids + "4 1 1 5 0 1\n" + ids + "4 1 1 5 0 1\n" + ids + "4 1 1 5 0 11\n" + ids + "4  1 1 5 0 11\n" +
           ids + "4 1 1 5 0 1\r\n" + toro + "4 1 1 5 0 1\n" + toro + "4 1 1 5 0 1\n" + ids + "4 1 1 5 0 1");
  Matrix<double, 3, 3> plain;
  plain << 4, 1, 1, 1, 5, 0, 1, 0, 1;
  Matrix<double, 3, 3> larger = plain;
  larger(2, 2) = 11;
  Matrix<double, 3, 3> other;
  other << 4, 1, 0, 1, 1, 1, 0, 1, 5;
  const std::vector<const Edge*> edges = edgesOf(graph);
  ASSERT_EQ(edges.size(), 8u);
  const std::vector<Matrix<double, 3, 3>> expected{plain, plain, larger, larger, plain, other, other, plain};
  for (std::size_t i = 0; i < edges.size(); ++i)
    EXPECT_EQ(static_cast<const Odometry2*>(edges[i])->information(), expected[i]) << i;
}

TEST(G2oReader, CountsRepeatedInformationThatIsNone) {
  ReadReport report;
  const std::string bad = "EDGE_SE2 0 1 1 2 3 1 2 0 1 0 7\n";
  const Graph graph =
      read(poses + bad + bad + edge + bad, {.information = InformationPolicy::clamp, .report = &report});
  EXPECT_EQ(report.clampedInformation, 3);
  const std::vector<const Edge*> edges = edgesOf(graph);
  for (const std::size_t i : {1u, 3u}) {
    EXPECT_EQ(static_cast<const Odometry2*>(edges[i])->information(),
              static_cast<const Odometry2*>(edges[0])->information());
  }
}

TEST(G2oReader, ReadsPlanarToro) {
  ReadReport report;
  const Graph graph = read("VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0.5\nEDGE2 0 1 1 2 3 11 2 22 33 4 5\n", {.report = &report});
  EXPECT_EQ(report.format, "toro");
  Matrix<double, 3, 3> expected;
  expected << 11, 2, 4, 2, 22, 5, 4, 5, 33;
  EXPECT_EQ(static_cast<const Odometry2&>(*edgesOf(graph).at(0)).information(), expected);
  read(poses, {.report = &report});
  EXPECT_EQ(report.format, "g2o");
}

TEST(G2oReader, ReadsBearingsAndRangesOfToro) {
  const Graph graph = read("VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nBR 0 7 0.3 2 0.1 0.5\n");
  EXPECT_FALSE(graph.vertex<Point2>(7).hasEstimate());
  const auto& sighting = static_cast<const test::Sighting2&>(*edgesOf(graph).at(0));
  EXPECT_NEAR(sighting.measurement()[0], 2.0 * std::cos(0.3), 1e-15);
  EXPECT_NEAR(sighting.measurement()[1], 2.0 * std::sin(0.3), 1e-15);
  // The covariance of (r cos β, r sin β) by its Jacobian.
  Matrix<double, 2, 2> J;
  J << std::cos(0.3), -2.0 * std::sin(0.3), std::sin(0.3), 2.0 * std::cos(0.3);
  const Matrix<double, 2, 2> covariance = J * Vector<double, 2>(0.25, 0.01).asDiagonal() * J.transpose();
  EXPECT_LT((sighting.information() * covariance - Matrix<double, 2, 2>::Identity()).norm(), 1e-13);
}

/// A file of several chunks with all that has its place: comments, data, marks.
std::string longText() {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  NumberWriter out;
  const auto real = [&] {
    out.character(' ');
    out.real(normal(random));
  };
  for (int i = 0; i < 20'000; ++i) {
    out.text(i % 100 == 5 ? "# comment\nVERTEX_SE2 " : "VERTEX_SE2 ");
    out.integer(i);
    for (int k = 0; k < 3; ++k) real();
    out.text(i % 70 == 3 ? "\nROBOTLASER1 1 2 3\n" : "\n");
    if (i == 0) continue;
    out.text("EDGE_SE2 ");
    out.integer(i - 1);
    out.character(' ');
    out.integer(i);
    for (int k = 0; k < 3; ++k) real();
    out.text(" 10 0.1 0.2 20 0.3 30\n");
    if (i % 50 == 7) out.text("#quiver level 3\n");
  }
  return std::string(out.view());
}

std::vector<double> numbersOf(const Graph& graph) {
  std::vector<double> numbers;
  graph.forEachVertex([&](const Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    numbers.insert(numbers.end(), type.values(vertex), type.values(vertex) + type.valueCount(vertex));
    const Attachment* attachment = graph.findAttachment(&vertex);
    numbers.push_back(attachment ? static_cast<double>(attachment->before.size() + 10 * attachment->after.size())
                                 : 0.0);
  });
  graph.forEachEdge([&](const Edge& e) {
    const auto& odometry = static_cast<const Odometry2&>(e);
    const double* z = odometry.measurementStore().values();
    numbers.insert(numbers.end(), z, z + 3);
    numbers.push_back(odometry.level());
    const auto information = odometry.informationStore().values();
    numbers.insert(numbers.end(), information.begin(), information.end());
  });
  return numbers;
}

TEST(G2oReader, IsTheSameForAnyNumberOfThreads) {
  const std::string text = longText();
  ASSERT_GT(text.size(), 2'000'000U);
  const std::vector<double> expected = numbersOf(read(text, {.threads = 1}));
  for (const int threads : {0, 2, 5}) EXPECT_EQ(numbersOf(read(text, {.threads = threads})), expected);
}

TEST(G2oReader, KeepsQuaternionsToTheLastBit) {
  const Graph graph = read("VERTEX_SE3:QUAT 0 1 2 3 0.1 0.2 -0.3 -0.9273618495495703\n");
  const Vector<double, 4> q = graph.vertex<Pose3>(0).estimate().rotation().coefficients();
  EXPECT_EQ(std::bit_cast<std::uint64_t>(q[3]), std::bit_cast<std::uint64_t>(-0.9273618495495703));
  EXPECT_EQ(q[0], 0.1);
}

TEST(G2oReader, TheGraphOutlivesTheText) {
  auto text = std::make_unique<std::string>(poses + "ROBOTLASER1 some data\n" + edge);
  const Graph graph = read(*text);
  text.reset();
  EXPECT_EQ(graph.findAttachment(graph.findVertex(1))->after.front(), "ROBOTLASER1 some data");
}

}  // namespace
}  // namespace quiver
