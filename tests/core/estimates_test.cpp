// Estimates that are saved and put back, or copied to another graph.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <quiver/core/graph/estimates.h>
#include <quiver/core/util/error.h>

#include "core_types.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Numbers = Vector<double, Dynamic>;

TEST(SavedEstimates, ComeBackWithWhatHasNone) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexPoint>(0, Vector<double, 2>(1.0, 2.0));
  graph.addVertex<VertexNumbers>(1, Numbers::Constant(3, 5.0));
  graph.addVertex<VertexPoint>(2);
  const SavedEstimates saved(graph);
  graph.vertex<VertexPoint>(0).setEstimate(Vector<double, 2>(7.0, 8.0));
  graph.vertex<VertexNumbers>(1).setEstimate(Numbers::Constant(3, 9.0));
  graph.vertex<VertexPoint>(2).setEstimate(Vector<double, 2>(7.0, 8.0));
  saved.restore(graph);
  EXPECT_EQ(graph.vertex<VertexPoint>(0).estimate(), (Vector<double, 2>(1.0, 2.0)));
  EXPECT_EQ(graph.vertex<VertexNumbers>(1).estimate(), Numbers::Constant(3, 5.0));
  EXPECT_FALSE(graph.vertex<VertexPoint>(2).hasEstimate());
}

TEST(SavedEstimates, RefuseAnotherGraph) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexPoint>(0, Vector<double, 2>(1.0, 2.0));
  graph.addVertex<VertexNumbers>(1, Numbers::Constant(3, 5.0));
  const SavedEstimates saved(graph);
  graph.vertex<VertexPoint>(0).setEstimate(Vector<double, 2>(7.0, 8.0));
  graph.vertex<VertexNumbers>(1).setEstimate(Numbers::Constant(200, 1.0));
  EXPECT_THAT([&] { saved.restore(graph); }, ThrowsMessage<GraphError>(HasSubstr("vertex 1 is not as it was")));
  EXPECT_EQ(graph.vertex<VertexPoint>(0).estimate(), (Vector<double, 2>(7.0, 8.0)));
  graph.removeVertex(1);
  EXPECT_THAT([&] { saved.restore(graph); }, ThrowsMessage<GraphError>(HasSubstr("vertex 1 is gone")));
}

TEST(CopyEstimates, GoesByClassesAndNotByRegistries) {
  auto other = std::make_shared<Registry>();
  other->addVertex<VertexNumbers>("VERTEX_NUMBERS");
  other->addVertex<VertexPoint>("VERTEX_POINT");
  Graph from(makeRegistry()), to(other);
  from.addVertex<VertexPoint>(0, Vector<double, 2>(1.0, 2.0));
  from.addVertex<VertexNumbers>(1, Numbers::Constant(3, 5.0));
  from.addVertex<VertexPoint>(2, Vector<double, 2>(3.0, 4.0));
  to.addVertex<VertexPoint>(0, Vector<double, 2>(0.0, 0.0));
  to.addVertex<VertexPoint>(1, Vector<double, 2>(0.5, 0.5));
  copyEstimates(from, to);
  EXPECT_EQ(to.vertex<VertexPoint>(0).estimate(), (Vector<double, 2>(1.0, 2.0)));
  EXPECT_EQ(to.vertex<VertexPoint>(1).estimate(), (Vector<double, 2>(0.5, 0.5)));
  to.addVertex<VertexNumbers>(3, Numbers::Constant(3, 5.0));
  from.addVertex<VertexNumbers>(3, Numbers::Constant(4, 5.0));
  EXPECT_THAT([&] { copyEstimates(from, to); },
              ThrowsMessage<GraphError>(HasSubstr("the estimates of vertex 3 have 4 and 3 numbers")));
}

}  // namespace
}  // namespace quiver
