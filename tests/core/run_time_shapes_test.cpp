// Edges and vertices of run-time size whose parts disagree: an exception that names the edge, never memory beyond.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/registry/conformance.h>
#include <quiver/core/util/error.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Numbers = Vector<double, Dynamic>;
using Square = Matrix<double, Dynamic, Dynamic>;

/// A block of one column too few.
class EdgeNarrow : public BaseEdge<EdgeNarrow, Dynamic, double, VertexNumbers> {
 public:
  static Numbers computeError(const double& z, const Numbers& x) { return (x.array() - z).matrix(); }
  static void linearizeOplus(const double&, const Numbers& x, Square& J) {
    J = Square::Identity(x.size(), x.size() - 1);
  }
};

/// A vertex whose estimate grows when it is moved.
class VertexGrowing : public BaseVertex<VertexGrowing, Dynamic, Numbers> {
 public:
  static Numbers oplus(const Numbers& x, const Numbers&) { return Numbers::Zero(x.size() + 1); }
  void read(FieldReader& reader) { setEstimate(Numbers::Constant(1, reader.real())); }
  void write(FieldWriter& writer) const { writer.real(values()[0]); }
  static std::vector<Field> fields() { return {{"value", "", ""}}; }
};
class EdgeGrowing : public BaseEdge<EdgeGrowing, Dynamic, double, VertexGrowing> {
 public:
  static Numbers computeError(const double& z, const Numbers& x) { return (x.head(1).array() - z).matrix(); }
  static void linearizeOplus(const double&, const Numbers&, Square& J) { J(0, 0) = 1.0; }
};

Graph numbers(int n) {
  auto registry = makeRegistry();
  registry->addEdge<EdgeNarrow>("EDGE_NARROW");
  registry->addVertex<VertexGrowing>("VERTEX_GROWING");
  registry->addEdge<EdgeGrowing>("EDGE_GROWING");
  Graph graph(registry);
  graph.addVertex<VertexNumbers>(7, Numbers::LinSpaced(n, 1.0, 2.0));
  return graph;
}

TEST(RunTimeShapes, InformationIsSquare) {
  Graph graph = numbers(3);
  for (const auto& [rows, columns] : {std::pair(3, 2), std::pair(2, 3), std::pair(0, 4)}) {
    const Square oblong = Square::Ones(rows, columns);
    EXPECT_THROW(graph.addEdge<EdgeSquares>({7}, 3.0, oblong), GraphError);
  }
  EXPECT_EQ(graph.edgeCount(), 0);
  EdgeSquares& edge = graph.addEdge<EdgeSquares>({7}, 3.0, Square::Identity(3, 3));
  EXPECT_THAT([&] { edge.setInformation(Square::Ones(3, 5)); },
              ThrowsMessage<GraphError>(HasSubstr("3 × 5; it must be square")));
  EXPECT_EQ(edge.information(), Square::Identity(3, 3));
}

TEST(RunTimeShapes, InformationHasTheRowsOfTheError) {
  for (const int rows : {1, 2, 4, 9}) {
    for (const char* algorithm : {"gn", "lm"}) {
      Graph graph = numbers(3);
      graph.addEdge<EdgeSquares>({7}, 3.0, Square::Identity(rows, rows));
      EXPECT_THAT([&] { (void)optimize(graph, {.algorithm = algorithm}); },
                  ThrowsMessage<GraphError>(HasSubstr("7: computeError returned 3 numbers, but the information")));
      EXPECT_EQ(graph.vertex<VertexNumbers>(7).estimate(), Numbers::LinSpaced(3, 1.0, 2.0));
    }
  }
}

TEST(RunTimeShapes, AVertexThatGrowsMeetsTheOldInformation) {
  Graph graph = numbers(3);
  graph.addEdge<EdgeSquares>({7}, 3.0, Square::Identity(3, 3));
  Optimizer optimizer;
  EXPECT_TRUE(optimizer.optimize(graph).converged());
  graph.vertex<VertexNumbers>(7).setEstimate(Numbers::Ones(5));
  EXPECT_THROW((void)optimizer.optimize(graph), GraphError);
  graph.vertex<VertexNumbers>(7).setEstimate(Numbers::Ones(3));
  EXPECT_TRUE(optimizer.optimize(graph).converged());
}

TEST(RunTimeShapes, BlocksKeepTheirSize) {
  Graph graph = numbers(3);
  graph.addEdge<EdgeNarrow>({7}, 3.0, Square::Identity(3, 3));
  EXPECT_THAT([&] { (void)optimize(graph); },
              ThrowsMessage<GraphError>(HasSubstr("linearizeOplus made a block of 3 × 2 that must be 3 × 3")));
}

TEST(RunTimeShapes, EstimatesKeepTheirSize) {
  Graph graph = numbers(3);
  graph.addVertex<VertexGrowing>(1, Numbers::Ones(1));
  graph.addEdge<EdgeGrowing>({1}, 3.0, Square::Identity(1, 1));
  EXPECT_THAT([&] { (void)optimize(graph); },
              ThrowsMessage<GraphError>(HasSubstr("VERTEX_GROWING: oplus returned an estimate of 2 numbers")));
}

TEST(RunTimeShapes, AnErrorHasAtLeastOneNumber) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexNumbers>(7, Vector<double, Dynamic>::Constant(2, 3.0));
  graph.addEdge<EdgeSquares>({7}, 2.0, Matrix<double, Dynamic, Dynamic>(0, 0));
  EXPECT_THAT([&] { (void)optimize(graph); },
              ThrowsMessage<GraphError>(HasSubstr("EdgeSquares 7 has an information matrix of 0 × 0")));
}

TEST(RunTimeShapes, Conform) {
  ConformanceOptions options;
  options.tags = {"VERTEX_NUMBERS", "EDGE_SQUARES"};
  const ConformanceReport report = checkConformance(makeRegistry(), options);
  EXPECT_TRUE(report.passed()) << report.describe();
  EXPECT_EQ(report.types, 2);
}

}  // namespace
}  // namespace quiver
