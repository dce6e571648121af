// Elements that are added through descriptors begin with their type's default.
#include <gtest/gtest.h>

#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/quiver.h>
#include <quiver/types_slam2d/edge_se2.h>
#include <quiver/types_slam2d/parameter_se2_offset.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam3d/edge_se3.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {
namespace {

struct Settings {
  double gain = 2.0;
  double bias = -1.0;
};

}  // namespace

template <>
struct Packing<Settings> {
  static constexpr int size = 2, coordinates = 2, dimension = 2;
  template <typename S>
  using Rebind = Settings;
  static void store(const Settings& x, double* out) {
    out[0] = x.gain;
    out[1] = x.bias;
  }
  template <typename S>
  static Settings load(const S* in) {
    return {in[0], in[1]};
  }
};

namespace {

class VertexSettings : public BaseVertex<VertexSettings, 2, Settings> {
 public:
  static Settings oplus(const Settings& x, const Vector<double, 2>& delta) {
    return {x.gain + delta[0], x.bias + delta[1]};
  }
  static std::vector<Field> fields() { return {{"gain", "", ""}, {"bias", "", ""}}; }
  void read(FieldReader& reader) {
    const double gain = reader.real();
    setEstimate({gain, reader.real()});
  }
  void write(FieldWriter& writer) const {
    writer.real(estimate().gain);
    writer.real(estimate().bias);
  }
};

template <typename E>
E& edgeByDescriptor(Graph& graph, std::vector<std::int64_t> vertices) {
  return static_cast<E&>(graph.addEdge(*graph.registry()->findEdgeTypeByName(typeName<E>()), vertices));
}

TEST(ElementDefaults, MeasurementsOfPosesAreTheIdentity) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>()).setFixed(true);
  graph.addVertex<VertexSE2>(1, SE2<double>(3.0, 0.0, 1.0));
  const auto& planar = edgeByDescriptor<EdgeSE2>(graph, {0, 1});
  EXPECT_EQ(planar.measurement().toVector(), SE2<double>().toVector());
  const Summary summary = optimize(graph);
  EXPECT_NEAR(summary.initialChi2, 10.0, 1e-12);
  EXPECT_LT(summary.finalChi2, 1e-20);
  EXPECT_LT((graph.vertex<VertexSE2>(1).estimate().toVector()).norm(), 1e-9);
}

TEST(ElementDefaults, RotationsAreRotationsInFilesToo) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE3>(0, SE3<double>());
  Vertex& blank = graph.addVertex<VertexSE3>(1);
  blank.setHasEstimate(true);
  const auto& spatial = edgeByDescriptor<EdgeSE3>(graph, {0, 1});
  EXPECT_EQ(spatial.measurement().rotation().w(), 1.0);
  const std::string text = graphText(graph);
  EXPECT_EQ(graphText(readGraphText(text, "text", builtinRegistry())), text);
}

TEST(ElementDefaults, ParametersAndValuesOfOnesOwn) {
  auto registry = builtinRegistry();
  registry->addVertex<VertexSettings>("VERTEX_SETTINGS");
  Graph graph(registry);
  const auto& parameter = static_cast<const ParameterSE2Offset&>(
      graph.addParameter(*registry->findParameterTypeByName(typeName<ParameterSE2Offset>()), 0));
  EXPECT_EQ(parameter.value().toVector(), SE2<double>().toVector());
  EXPECT_EQ(parameter.value().rotation().cosine(), 1.0);
  EXPECT_EQ(graph.addVertex<VertexSettings>(5).estimate().gain, 2.0);
  EXPECT_EQ(graph.vertex<VertexSettings>(5).estimate().bias, -1.0);
}

}  // namespace
}  // namespace quiver
