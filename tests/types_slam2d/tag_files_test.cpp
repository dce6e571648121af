// A real file of every planar tag: it loads, Jacobians pass, and it comes back byte by byte.
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_slam2d/register.h>

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

TEST(PlanarTags, AreAllInTheFiles) {
  Registry planar;
  registerSlam2d(planar);
  const std::set<std::string> there = tagsOf(readGraph(dataFile("every_tag.g2o"), builtinRegistry()));
  for (const auto& type : planar.vertexTypes()) EXPECT_TRUE(there.contains(type->tag())) << type->tag();
  for (const auto& type : planar.edgeTypes()) EXPECT_TRUE(there.contains(type->tag())) << type->tag();
  for (const auto& type : planar.parameterTypes()) EXPECT_TRUE(there.contains(type->tag())) << type->tag();
}

TEST(PlanarTags, RoundTripByteByByte) {
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

TEST(PlanarTags, JacobiansPass) {
  const JacobianReport report = checkJacobians(readGraph(dataFile("every_tag.g2o"), builtinRegistry()));
  EXPECT_LT(report.worstDeviation(), 1e-6) << report.describe();
}

}  // namespace
}  // namespace quiver
