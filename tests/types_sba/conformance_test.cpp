#include <map>

#include <gtest/gtest.h>

#include <quiver/core/registry/conformance.h>
#include <quiver/types_sba/register.h>
#include <quiver/types_slam3d/register.h>

namespace quiver {
namespace {

constexpr std::uint32_t bit(GaugeDirection direction) { return std::uint32_t{1} << direction; }
constexpr std::uint32_t translations = bit(gaugeX) | bit(gaugeY) | bit(gaugeZ);
constexpr std::uint32_t rigid = translations | bit(gaugeRoll) | bit(gaugePitch) | bit(gaugeYaw);
constexpr std::uint32_t similarity = rigid | bit(gaugeScale);

std::shared_ptr<Registry> registry() {
  auto result = std::make_shared<Registry>();
  registerSlam3d(*result);
  registerSba(*result);
  return result;
}

/// The tags that registerSba() adds.
std::vector<std::string> ownTags(const Registry& all) {
  Registry slam;
  registerSlam3d(slam);
  std::vector<std::string> tags;
  for (const auto& type : all.vertexTypes()) {
    if (!slam.findVertexType(type->tag())) tags.push_back(type->tag());
  }
  for (const auto& type : all.edgeTypes()) {
    if (!slam.findEdgeType(type->tag())) tags.push_back(type->tag());
  }
  for (const auto& type : all.parameterTypes()) {
    if (!slam.findParameterType(type->tag())) tags.push_back(type->tag());
  }
  return tags;
}

TEST(SbaTypes, Conform) {
  const auto all = registry();
  ConformanceOptions options;
  options.tags = ownTags(*all);
  for (options.seed = 1; options.seed <= 10; ++options.seed) {
    const ConformanceReport report = checkConformance(all, options);
    EXPECT_TRUE(report.passed()) << options.seed << ": " << report.describe();
    EXPECT_EQ(report.types, static_cast<int>(options.tags.size()));
  }
  EXPECT_EQ(options.tags.size(), 42u);
}

TEST(SbaTypes, HaveAnalyticJacobiansInLanes) {
  const auto all = registry();
  for (const std::string& tag : ownTags(*all)) {
    const EdgeType* type = all->findEdgeType(tag);
    if (!type) continue;
    EXPECT_EQ(type->form().jacobians, Jacobians::analytic) << tag;
    EXPECT_TRUE(type->form().lanes) << tag << ": " << type->form().reason;
  }
}

TEST(SbaTypes, MeasurementsFollowTheWorld) {
  std::map<std::string, std::uint32_t> found;
  for (const WorldInvariance& invariance : checkConformance(registry()).invariances)
    found[invariance.tag] = invariance.directions;
  for (const char* tag :
       {"EDGE_PROJECT_BAL", "EDGE_PROJECT_P2MC", "EDGE_PROJECT_P2MC_INTRINSICS", "EDGE_PROJECT_XYZ2UV:EXPMAP",
        "EDGE_SE3_PROJECT_XYZ:EXPMAP", "EDGE_PROJECT_INVERSE_DEPTH", "EDGE_SIM3:EXPMAP", "EDGE_PROJECT_SIM3_XYZ:EXPMAP",
        "EDGE_PROJECT_PINHOLE", "EDGE_PROJECT_BROWN", "EDGE_PROJECT_FISHEYE", "EDGE_PROJECT_SNAVELY",
        "EDGE_PROJECT_PINHOLE:INTRINSICS", "EDGE_PROJECT_BROWN:INTRINSICS", "EDGE_PROJECT_FISHEYE:INTRINSICS",
        "EDGE_PROJECT_SNAVELY:INTRINSICS"}) {
    EXPECT_EQ(found.at(tag), similarity) << tag;
  }
  for (const char* tag : {"EDGE_PROJECT_P2SC", "EDGE_CAM", "EDGE_SCALE", "EDGE_PROJECT_XYZ2UVU:EXPMAP",
                          "EDGE_STEREO_SE3_PROJECT_XYZ:EXPMAP"}) {
    EXPECT_EQ(found.at(tag), rigid) << tag;
  }
  EXPECT_EQ(found.at("EDGE_SE3_PROJECT_XYZONLYPOSE:EXPMAP"), 0u);
  EXPECT_EQ(found.at("EDGE_STEREO_SE3_PROJECT_XYZONLYPOSE:EXPMAP"), 0u);
}

}  // namespace
}  // namespace quiver
