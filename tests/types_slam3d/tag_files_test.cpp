// Real files of every spatial tag: they load, their Jacobians pass, and they come back: byte by byte, or as TORO's
// Euler angles do, to 1e-14.
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_slam3d/register.h>

namespace quiver {
namespace {

std::string dataFile(const std::string& name) { return std::string(QUIVER_TEST_FILES) + "/" + name; }

std::set<std::string> tagsOf(const Graph& graph) {
  std::set<std::string> tags;
  graph.forEachVertex([&](const Vertex& vertex) { tags.insert(graph.typeOf(vertex).tag()); });
  graph.forEachEdge([&](const Edge& edge) { tags.insert(graph.typeOf(edge).tag()); });
  graph.forEachParameter([&](const Parameter& parameter) { tags.insert(graph.typeOf(parameter).tag()); });
  return tags;
}

TEST(SpatialTags, AreAllInTheFiles) {
  Registry spatial;
  registerSlam3d(spatial);
  std::set<std::string> there = tagsOf(readGraph(dataFile("every_tag.g2o"), builtinRegistry()));
  there.merge(tagsOf(readGraph(dataFile("euler.graph"), builtinRegistry())));
  for (const auto& type : spatial.vertexTypes()) EXPECT_TRUE(there.contains(type->tag())) << type->tag();
  for (const auto& type : spatial.edgeTypes()) EXPECT_TRUE(there.contains(type->tag())) << type->tag();
  for (const auto& type : spatial.parameterTypes()) EXPECT_TRUE(there.contains(type->tag())) << type->tag();
}

TEST(SpatialTags, RoundTripByteByByte) {
  const std::string once = graphText(readGraph(dataFile("every_tag.g2o"), builtinRegistry()));
  EXPECT_EQ(graphText(readGraphText(once, "written", builtinRegistry())), once);
  // The lines are those of the file; only their order is the writer's.
  std::ifstream file(dataFile("every_tag.g2o"));
  std::multiset<std::string> read, written;
  for (std::string line; std::getline(file, line);) read.insert(line);
  std::istringstream text(once);
  for (std::string line; std::getline(text, line);) written.insert(line);
  EXPECT_EQ(read, written);
}

TEST(SpatialTags, EulerAnglesRoundTrip) {
  const std::string path = dataFile("euler.graph");
  std::ifstream file(path);
  std::istringstream written(graphText(readGraph(path, builtinRegistry())));
  std::string expected, found;
  int lines = 0;
  while (std::getline(file, expected)) {
    ASSERT_TRUE(std::getline(written, found));
    ++lines;
    std::istringstream a(expected), b(found);
    std::string tagA, tagB;
    a >> tagA;
    b >> tagB;
    EXPECT_EQ(tagA, tagB);
    std::vector<double> x, y;
    for (double value; a >> value;) x.push_back(value);
    for (double value; b >> value;) y.push_back(value);
    ASSERT_EQ(x.size(), y.size()) << found;
    // Information entries are sums of products with the map between the angles and the quaternion: relative to the
    // largest number of the line.
    double largest = 0.0;
    for (const double value : x) largest = std::max(largest, std::abs(value));
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(y[i], x[i], 1e-14 * largest) << found;
  }
  EXPECT_EQ(lines, 5);
}

TEST(SpatialTags, JacobiansPass) {
  // All but those of EDGE_SE3:LOG_APPROXIMATE, which is there to show what approximate ones cost.
  for (const char* name : {"every_tag.g2o", "euler.graph"}) {
    const Graph graph = readGraph(dataFile(name), builtinRegistry());
    JacobianReport report = checkJacobians(graph);
    std::erase_if(report.types, [](const auto& type) { return type.tag == "EDGE_SE3:LOG_APPROXIMATE"; });
    EXPECT_LT(report.worstDeviation(), 1e-6) << report.describe();
  }
}

}  // namespace
}  // namespace quiver
