#include <map>

#include <gtest/gtest.h>

#include <quiver/core/registry/conformance.h>
#include <quiver/types_slam2d/register.h>
#include <quiver/types_slam3d/register.h>

namespace quiver {
namespace {

constexpr std::uint32_t bit(GaugeDirection direction) { return std::uint32_t{1} << direction; }
constexpr std::uint32_t planar = bit(gaugeX) | bit(gaugeY) | bit(gaugeYaw);
constexpr std::uint32_t translations = bit(gaugeX) | bit(gaugeY) | bit(gaugeZ);
constexpr std::uint32_t rigid = translations | bit(gaugeRoll) | bit(gaugePitch) | bit(gaugeYaw);

constexpr std::uint64_t seeds = 10;

ConformanceReport check(void (*fill)(Registry&), ConformanceOptions options = {}) {
  auto registry = std::make_shared<Registry>();
  fill(*registry);
  return checkConformance(registry, options);
}

std::map<std::string, std::uint32_t> invariances(const ConformanceReport& report) {
  std::map<std::string, std::uint32_t> result;
  for (const WorldInvariance& invariance : report.invariances) result[invariance.tag] = invariance.directions;
  return result;
}

TEST(BuiltinTypes, PlanarOnesConform) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    ConformanceOptions options;
    options.seed = seed;
    const ConformanceReport report = check(registerSlam2d, options);
    EXPECT_TRUE(report.passed()) << report.describe();
    EXPECT_EQ(report.types, 23);
  }
}

TEST(BuiltinTypes, SpatialOnesConform) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    ConformanceOptions options;
    options.seed = seed;
    options.approximateJacobians = {"EDGE_SE3:LOG_APPROXIMATE"};
    const ConformanceReport report = check(registerSlam3d, options);
    EXPECT_TRUE(report.passed()) << report.describe();
    EXPECT_EQ(report.types, 25);
  }
}

TEST(BuiltinTypes, PlanarMeasurementsFollowTheWorld) {
  std::map<std::string, std::uint32_t> found = invariances(check(registerSlam2d));
  const auto inPlane = [&](const char* tag) { return found.at(tag) & (planar | bit(gaugeScale)); };
  for (const char* tag : {"EDGE_SE2", "EDGE_SE2_XY", "EDGE_SE2_OFFSET", "EDGE_SE2_POINTXY_OFFSET",
                          "EDGE_SE2_TWOPOINTSXY", "EDGE_SE2_LOTSOFXY", "EDGE_SE2_SEGMENT2D", "EDGE_SE2_SEGMENT2D_LINE",
                          "EDGE_SE2_SEGMENT2D_POINTLINE", "EDGE_SE2_LINE2D", "EDGE_LINE2D_POINTXY"}) {
    EXPECT_EQ(inPlane(tag), planar) << tag;
  }
  EXPECT_EQ(inPlane("EDGE_BEARING_SE2_XY"), planar | bit(gaugeScale));
  EXPECT_EQ(inPlane("EDGE_POINTXY"), bit(gaugeX) | bit(gaugeY));
  EXPECT_EQ(inPlane("EDGE_PRIOR_SE2"), 0u);
}

TEST(BuiltinTypes, SpatialMeasurementsFollowTheWorld) {
  std::map<std::string, std::uint32_t> found = invariances(check(registerSlam3d));
  for (const char* tag :
       {"EDGE_SE3:QUAT", "EDGE_SE3:LOG", "EDGE_SE3:LOG_APPROXIMATE", "EDGE3", "EDGE_SE3_OFFSET", "EDGE_SE3_TRACKXYZ",
        "EDGE_PROJECT_DEPTH", "EDGE_PROJECT_DISPARITY", "EDGE_SE3_LOTSOF_XYZ", "EDGE_SE3_LINE3D"}) {
    EXPECT_EQ(found.at(tag), rigid) << tag;
  }
  EXPECT_EQ(found.at("EDGE_POINTXYZ"), translations);
  EXPECT_EQ(found.at("EDGE_SE3_PRIOR"), 0u);
  EXPECT_EQ(found.at("EDGE_SE3_XYZ_PRIOR"), 0u);
}

}  // namespace
}  // namespace quiver
