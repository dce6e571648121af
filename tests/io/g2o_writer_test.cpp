#include <clocale>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <locale>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <tests/io/graph_types.h>
#include <tests/io/temporary_folder.h>

namespace quiver {
namespace {

using test::messageOf;
using test::Odometry2;
using test::Odometry3;
using test::Panorama2;
using test::Point2;
using test::Pose2;
using test::Pose3;

Graph read(const std::string& text) {
  return readGraphText(text, "a.g2o", test::makeRegistry(), {.unknown = UnknownTags::keep});
}

/// A graph with an element of every shape and every mark.
Graph everything() {
  Graph graph(test::makeRegistry());
  graph.addParameter<test::Offset2>(4, SE2<double>(0.1, 0.2, 0.3));
  graph.addParameter<test::Scale>(0, 1.0 / 3.0);
  graph.addVertex<Pose3>(12, SE3<double>(SO3<double>(0.1, 0.2, 0.3, 0.9), Vector<double, 3>(1, 2, 3)));
  graph.addVertex<Pose3>(3, SE3<double>(SO3<double>(-0.5, 0.5, 0.5, -0.5), Vector<double, 3>(1e-300, -0.0, 1e300)));
  graph.addVertex<Pose2>(1, SE2<double>(0.5, 1.0 / 3.0, -3.0)).setFixed(true);
  graph.addVertex<Pose2>(2).setFixedDirections(4);
  graph.addVertex<Point2>(7, Vector<double, 2>(1e22, -1e-7)).setFixedDirections(2);
  graph.addVertex<Point2>(8, Vector<double, 2>(1, 2)).setFixedDirections(3);
  auto& odometry = graph.addEdge<Odometry2>({1, 2}, SE2<double>(1, 2, 3), Matrix<double, 3, 3>::Identity());
  odometry.setRobustKernel(RobustKernelHuber(0.7));
  odometry.setLevel(3);
  graph.addEdge<Odometry3>({12, 3}, SE3<double>(), Matrix<double, 6, 6>::Identity());
  graph.addEdge<test::OffsetSighting2>({1, 7}, Vector<double, 2>(1, 2), Matrix<double, 2, 2>::Identity(), {4});
  const std::array<std::int64_t, 3> ids{2, 8, 7};
  auto& panorama = static_cast<Panorama2&>(graph.addEdge(*graph.registry()->findEdgeType("EDGE_SE2_LOTSOFXY"), ids));
  panorama.setMeasurement({1, 2, 3, 4});
  panorama.setInformation(Matrix<double, Dynamic, Dynamic>::Identity(4, 4));
  graph.fileAttachment() = {{"# head"}, {"# tail"}};
  graph.attachment(*graph.findVertex(3)) = {{"# of vertex 3"}, {"ROBOTLASER1 1 2", "# in between", "FOO bar"}};
  graph.attachment(odometry) = {{"# of the edge"}, {"ROBOTLASER1 3"}};
  return graph;
}

constexpr const char* everythingText =
    "# head\n"
    "PARAMS_SCALE 0 0.3333333333333333\n"
    "PARAMS_SE2OFFSET 4 0.1 0.2 0.3\n"
    "VERTEX_SE2 1 0.5 0.3333333333333333 -3\n"
    "FIX 1\n"
    "#quiver vertex VERTEX_SE2 2\n"
    "#quiver fixed 2\n"
    "# of vertex 3\n"
    "VERTEX_SE3:QUAT 3 1e-300 -0 1e+300 -0.5 0.5 0.5 -0.5\n"
    "ROBOTLASER1 1 2\n"
    "# in between\n"
    "FOO bar\n"
    "VERTEX_XY 7 1e+22 -1e-07\n"
    "#quiver fixed 1\n"
    "VERTEX_XY 8 1 2\n"
    "FIX 8\n"
    "VERTEX_SE3:QUAT 12 1 2 3 ";

TEST(G2oWriter, WritesElementsInOrderWithAllThatBelongsToThem) {
  const std::string text = graphText(everything());
  EXPECT_EQ(text.substr(0, std::string(everythingText).size()), everythingText);
  const std::string rest =
      "# of the edge\n"
      "EDGE_SE2 1 2 1 2 3 1 0 0 1 0 1\n"
      "#quiver kernel Huber 0.7\n"
      "#quiver level 3\n"
      "ROBOTLASER1 3\n"
      "EDGE_SE2_POINTXY_OFFSET 1 7 4 1 2 1 0 1\n"
      "EDGE_SE3:QUAT 12 3 0 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
      "EDGE_SE2_LOTSOFXY 2 8 7 || 2 1 2 3 4 1 0 0 0 1 0 0 1 0 1\n"
      "# tail\n";
  ASSERT_GE(text.size(), rest.size());
  EXPECT_EQ(text.substr(text.size() - rest.size()), rest);
}

TEST(G2oWriter, ReadsBackToTheSameBytes) {
  const std::string text = graphText(everything());
  EXPECT_EQ(graphText(read(text)), text);
}

TEST(G2oWriter, LeavesMarksOutOnRequest) {
  const std::string text = graphText(everything(), {.annotations = false});
  EXPECT_EQ(text.find("#quiver"), std::string::npos);
  EXPECT_EQ(text.find("VERTEX_SE2 2"), std::string::npos);
  EXPECT_NE(text.find("# of vertex 3"), std::string::npos);
}

TEST(G2oWriter, LeavesOutVerticesThatEdgesTell) {
  const std::string text = "# top\nEDGE_SE2 9 5 1 2 3 1 0 0 1 0 1\nEDGE_SE2_XY 5 2 1 0 1 0 1\nFIX 2\nFIX 9\n# end\n";
  EXPECT_EQ(graphText(read(text)), text);
  Graph graph = read(text);
  graph.addVertex<Point2>(100);
  const std::string longer = graphText(graph);
  EXPECT_NE(longer.find("#quiver vertex VERTEX_XY 100\n"), std::string::npos);
  EXPECT_EQ(graphText(read(longer)), longer);
}

std::string randomText(int vertices) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  Graph graph(test::makeRegistry());
  for (int i = 0; i < vertices; ++i) {
    const SO3<double> rotation(normal(random), normal(random), normal(random), normal(random));
    graph.addVertex<Pose3>(i, SE3<double>(rotation, Vector<double, 3>::NullaryExpr([&] { return normal(random); })));
    if (i % 7 == 0) graph.findVertex(i)->setFixed(true);
    if (i == 0) continue;
    Matrix<double, 6, 6> root;
    for (double& value : root.reshaped()) value = normal(random);
    const SO3<double> turn(normal(random), normal(random), normal(random), normal(random));
    const Matrix<double, 6, 6> information = root * root.transpose();
    const Matrix<double, 6, 6> symmetric = 0.5 * (information + information.transpose());
    graph.addEdge<Odometry3>({i - 1, i}, SE3<double>(turn, Vector<double, 3>(normal(random), 0.0, normal(random))),
                             symmetric);
  }
  return graphText(graph);
}

TEST(G2oWriter, RoundTripsRandomGraphsByteByByte) {
  const std::string text = randomText(5000);
  ASSERT_GT(text.size(), 1'000'000U);
  EXPECT_TRUE(graphText(read(text)) == text);
}

TEST(G2oWriter, WritesTheSameBytesForAnyNumberOfThreads) {
  const Graph graph = read(randomText(5000));
  const std::string text = graphText(graph, {.threads = 1});
  for (const int threads : {0, 2, 5}) EXPECT_TRUE(graphText(graph, {.threads = threads}) == text);
}

TEST(G2oWriter, WritesPlainAndCompressedFiles) {
  const test::TemporaryFolder folder;
  const Graph graph = everything();
  const std::string text = graphText(graph);
  for (const char* name : {"a.g2o", "a.g2o.gz", "a.g2o.bz2"}) {
    const std::string path = folder.path(name);
    writeGraph(path, graph);
    ReadReport report;
    EXPECT_EQ(graphText(readGraph(path, test::makeRegistry(), {.unknown = UnknownTags::keep, .report = &report})),
              text);
    EXPECT_EQ(report.textBytes, static_cast<std::int64_t>(text.size()));
    EXPECT_EQ(report.storedBytes, static_cast<std::int64_t>(std::filesystem::file_size(path)));
  }
  EXPECT_EQ(test::readBytes(folder.path("a.g2o")), text);
  EXPECT_THROW(writeGraph(folder.path("no/a.g2o"), graph), FileError);
}

TEST(G2oWriter, RefusesNumbersThatNoFileCanHold) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path("a.g2o");
  test::writeBytes(path, "old");
  Graph graph(test::makeRegistry());
  graph.addVertex<Point2>(5, Vector<double, 2>(1.0, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(messageOf<GraphError>([&] { writeGraph(path, graph); }),
            "vertex 5 (VERTEX_XY) holds the value nan, which no file can");
  EXPECT_EQ(test::readBytes(path), "old");
  EXPECT_EQ(folder.fileCount(), 1U);
}

TEST(G2oWriter, RefusesAttachmentsThatAreNoLines) {
  Graph graph(test::makeRegistry());
  graph.attachment(graph.addVertex<Point2>(5, Vector<double, 2>(1, 2))).before = {"# two\nlines"};
  EXPECT_THROW(graphText(graph), GraphError);
}

/// Decimal comma and grouped digits, as in many countries.
class CommaNumbers : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(G2oWriter, RefusesAttachmentsThatWouldBeReadAsElements) {
  const auto refuses = [](std::vector<std::string> before, std::vector<std::string> after) {
    Graph graph = everything();
    graph.attachment(*graph.findVertex(3)) = {std::move(before), std::move(after)};
    EXPECT_THROW((void)graphText(graph), GraphError);
  };
  refuses({"hello"}, {});
  refuses({"ROBOTLASER1 1 2"}, {});
  refuses({"#quiver level 3"}, {});
  refuses({}, {"FIX 3"});
  refuses({}, {"  VERTEX_XY 17 1 2"});
  Graph graph = everything();
  graph.attachment(*graph.findVertex(3)) = {{"# fine", "", "  # too"}, {"ROBOTLASER1 1 2"}};
  EXPECT_NO_THROW((void)graphText(graph));
}

TEST(G2oWriter, DoesNotDependOnTheLocale) {
  const std::string text = graphText(everything());
  const std::string before = std::setlocale(LC_ALL, nullptr);
  const std::locale old = std::locale::global(std::locale(std::locale::classic(), new CommaNumbers));
  std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
  const std::string again = graphText(read(text));
  std::locale::global(old);
  std::setlocale(LC_ALL, before.c_str());
  EXPECT_EQ(again, text);
}

/// The published graphs beside the checkout, or where QUIVER_DATA points.
std::filesystem::path dataFolder() {
  if (const char* folder = std::getenv("QUIVER_DATA")) return folder;
  for (std::filesystem::path folder = std::filesystem::current_path();; folder = folder.parent_path()) {
    if (std::filesystem::exists(folder / "shared/data")) return folder / "shared/data";
    if (folder == folder.parent_path()) return {};
  }
}

TEST(G2oWriter, RoundTripsPublishedGraphsByteByByte) {
  std::error_code missing;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(dataFolder(), missing)) {
    if (entry.path().extension() != ".g2o") continue;
    const std::string once = graphText(readGraph(entry.path().string(), test::makeRegistry()));
    EXPECT_TRUE(graphText(read(once)) == once) << entry.path();
    ++count;
  }
  if (count == 0) GTEST_SKIP() << "no published graphs beside this checkout";
}

}  // namespace
}  // namespace quiver
