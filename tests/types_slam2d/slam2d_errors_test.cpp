#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include <quiver/core/registry/field_tokens.h>
#include <quiver/core/registry/registry.h>
#include <quiver/core/util/error.h>
#include <quiver/types_slam2d/addons/edge_line2d.h>
#include <quiver/types_slam2d/addons/edge_segment2d.h>
#include <quiver/types_slam2d/edge_se2_bearing.h>
#include <quiver/types_slam2d/edge_se2_offset.h>
#include <quiver/types_slam2d/register.h>

namespace quiver {
namespace {

using Vector2 = Vector<double, 2>;
constexpr double exact = 1e-14;  // a handful of roundings of numbers around 1

TEST(BearingEdge, IsMeasuredLessPredictedAndWrapped) {
  const SE2<double> pose(1.0, 2.0, pi / 2);
  const Vector2 left(0.0, 2.0);  // to the left of a robot that looks along y
  EXPECT_NEAR(EdgeBearingSE2XY::computeError<double>(0.5, pose, left)[0], 0.5 - pi / 2, exact);
  EXPECT_NEAR(EdgeBearingSE2XY::computeError<double>(-3.0, pose, left)[0], 1.5 * pi - 3.0, exact);
  SE2<double> known = pose;
  Vector2 point;
  ASSERT_TRUE(EdgeBearingSE2XY::initialEstimate(1, pi / 2, known, point));
  EXPECT_LT((point - Vector2(-1.0, 2.0)).norm(), exact);
}

TEST(OffsetEdges, HonourTheSensorsPose) {
  SE2<double> pose(1.0, -2.0, 0.7);
  const SE2<double> sensor(0.5, 0.25, -1.2);
  const Vector2 z(3.0, 1.0);
  Vector2 point;
  ASSERT_TRUE(EdgeSE2XYOffset::initialEstimate(1, z, sensor, pose, point));
  EXPECT_LT((point - pose * (sensor * z)).norm(), exact);
  EXPECT_LT(EdgeSE2XYOffset::computeError<double>(z, sensor, pose, point).norm(), exact);
  EXPECT_LT(EdgeSE2XYCalibration::computeError<double>(z, pose, point, sensor).norm(), exact);

  SE2<double> second;
  const SE2<double> other(-0.1, 0.2, 0.3), motion(1.0, 0.1, 0.2);
  ASSERT_TRUE(EdgeSE2Offset::initialEstimate(1, motion, sensor, other, pose, second));
  EXPECT_LT(EdgeSE2Offset::computeError<double>(motion, sensor, other, pose, second).norm(), exact);
  SE2<double> first;
  ASSERT_TRUE(EdgeSE2Offset::initialEstimate(0, motion, sensor, other, first, second));
  EXPECT_LT((first.toVector() - pose.toVector()).norm(), exact);
}

TEST(SegmentEdges, NormalIsToTheRight) {
  // A wall from (2, -1) to (2, 1): going up it, the right is +x, 2 m away.
  const Vector<double, 4> wall(2.0, -1.0, 2.0, 1.0);
  const SE2<double> origin;
  EXPECT_LT(EdgeSE2Segment2DLine::computeError<double>(Vector2(0.0, 2.0), origin, wall).norm(), exact);
  const SE2<double> pose(0.5, 0.0, pi / 2);
  EXPECT_LT(EdgeSE2Segment2DLine::computeError<double>(Vector2(-pi / 2, 1.5), pose, wall).norm(), exact);
  const Vector<double, 4> upperEnd(1.0, 2.0, 1.0, 0.0), lowerEnd(0.0, 2.0, -1.0, 0.0);
  EXPECT_LT(EdgeSE2Segment2DPointLine::computeError<double>(upperEnd, origin, wall).norm(), exact);
  EXPECT_LT(EdgeSE2Segment2DPointLine::computeError<double>(lowerEnd, origin, wall).norm(), exact);
}

TEST(LineEdges, AnglesAreWrapped) {
  const Vector2 from(3.0, 1.0), to(-3.0, 2.0);
  const Vector2 error = EdgeLine2D::computeError<double>(Vector2(0.0, 1.0), from, to);
  EXPECT_NEAR(error[0], 2.0 * pi - 6.0, exact);
  EXPECT_NEAR(error[1], 0.0, exact);
  // The line x = 2 from a pose at (0.5, 0) that looks along y.
  const SE2<double> pose(0.5, 0.0, pi / 2);
  EXPECT_LT(EdgeSE2Line2D::computeError<double>(Vector2(-pi / 2, 1.5), pose, Vector2(0.0, 2.0)).norm(), exact);
  EXPECT_NEAR(EdgeLine2DXY::computeError<double>(0.5, Vector2(0.0, 2.0), Vector2(2.75, 9.0))[0], 0.25, exact);
}

TEST(LineVertices, HaveBothEndsOrNone) {
  for (int ends = 0; ends <= 2; ++ends) {
    detail::TokenWriter line;
    line.real(0.5);
    line.real(2.0);
    for (int end = 0; end < ends; ++end) line.integer(10 + end);
    detail::TokenReader reader(line.tokens());
    VertexLine2D vertex;
    if (ends == 1) {
      EXPECT_THROW(vertex.read(reader), ParseError);
      continue;
    }
    vertex.read(reader);
    EXPECT_EQ(vertex.firstEnd(), ends == 0 ? -1 : 10);
    EXPECT_EQ(vertex.secondEnd(), ends == 0 ? -1 : 11);
  }
}

TEST(Slam2d, KnowsDataLines) {
  Registry registry;
  registerSlam2d(registry);
  EXPECT_TRUE(registry.isDataTag("ROBOTLASER1"));
  EXPECT_TRUE(registry.isDataTag("VERTEX_TAG"));
  EXPECT_NE(registry.findEdgeType("EDGE_SE2_LOTSOFXY"), nullptr);
}

}  // namespace
}  // namespace quiver
