#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <quiver/core/util/error.h>
#include <quiver/evaluation/trajectory_error.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam2d/vertex_xy.h>

namespace quiver {
namespace {

using Pose = SE3<double>;
using Vector3 = Vector<double, 3>;
constexpr double rounding = 1e-12;  // sums of some hundred numbers around 10

Trajectory along(std::initializer_list<Vector3> points) {
  Trajectory trajectory;
  for (const Vector3& p : points)
    trajectory.poses.push_back({static_cast<double>(trajectory.poses.size()), Pose(SO3<double>(), p)});
  return trajectory;
}

Trajectory randomWalk(unsigned seed, int count) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Trajectory trajectory;
  Pose pose;
  for (int i = 0; i < count; ++i) {
    Vector<double, 6> step;
    for (int k = 0; k < 6; ++k) step[k] = uniform(engine);
    pose = pose * Pose::exp(step);
    trajectory.poses.push_back({static_cast<double>(i), pose});
  }
  return trajectory;
}

Trajectory moved(const Pose& motion, Trajectory trajectory, double scale = 1.0) {
  for (TrajectoryPose& p : trajectory.poses) {
    const Pose image = motion * Pose(p.pose.rotation(), scale * p.pose.translation());
    p.pose = image;
  }
  return trajectory;
}

Pose someMotion() {
  Vector<double, 6> tangent;
  tangent << 3.0, -7.0, 2.0, 0.8, -1.9, 0.6;
  return Pose::exp(tangent);
}

TEST(TrajectoryError, ByHandWithoutAlignment) {
  const Trajectory truth = along({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  const Trajectory estimate = along({{0, 0, 0}, {1, 3, 0}, {2, 0, 4}, {3, 0, 0}});
  const TrajectoryError error = evaluateTrajectory(estimate, truth, {.alignment = AlignmentGroup::none});
  EXPECT_EQ(error.matched, 4);
  EXPECT_DOUBLE_EQ(error.absoluteTranslation.rootMeanSquare, 2.5);  // √((9 + 16)/4)
  EXPECT_DOUBLE_EQ(error.absoluteTranslation.mean, 1.75);
  EXPECT_DOUBLE_EQ(error.absoluteTranslation.median, 1.5);
  EXPECT_DOUBLE_EQ(error.absoluteTranslation.largest, 4.0);
  EXPECT_DOUBLE_EQ(error.absoluteTranslation.least, 0.0);
  EXPECT_DOUBLE_EQ(error.absoluteTranslation.deviation, std::sqrt(6.25 - 1.75 * 1.75));
  EXPECT_EQ(error.relativeTranslation.count, 3);
  EXPECT_DOUBLE_EQ(error.relativeTranslation.mean, 4.0);  // 3, 5, 4
  EXPECT_DOUBLE_EQ(error.relativeTranslation.rootMeanSquare, std::sqrt(50.0 / 3.0));
  EXPECT_EQ(error.absoluteRotation.largest, 0.0);
}

TEST(TrajectoryError, ByHandWithATurn) {
  // The second pose looks 90 degrees to the left of the truth: the way on from it goes wrong by √2.
  Trajectory truth = along({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  Trajectory estimate = truth;
  estimate.poses[1].pose = Pose(SO3<double>::exp(Vector3(0, 0, std::numbers::pi / 2)), Vector3(1, 0, 0));
  const TrajectoryError error = evaluateTrajectory(estimate, truth, {.alignment = AlignmentGroup::none});
  EXPECT_NEAR(error.absoluteRotation.largest, std::numbers::pi / 2, rounding);
  EXPECT_NEAR(error.absoluteRotation.mean, std::numbers::pi / 6, rounding);
  EXPECT_NEAR(error.relativeTranslation.least, 0.0, rounding);
  EXPECT_NEAR(error.relativeTranslation.largest, std::sqrt(2.0), rounding);
  EXPECT_NEAR(error.relativeRotation.mean, std::numbers::pi / 2, rounding);
}

TEST(TrajectoryError, ByHandAfterAlignment) {
  // A square against one twice as large, shifted: only a scale brings them together; rigidly each corner is off by √½.
  const Trajectory truth = along({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const Trajectory estimate = along({{5, 5, 1}, {7, 5, 1}, {7, 7, 1}, {5, 7, 1}});
  const TrajectoryError rigid = evaluateTrajectory(estimate, truth, {.alignment = AlignmentGroup::se3});
  EXPECT_NEAR(rigid.absoluteTranslation.rootMeanSquare, std::sqrt(0.5), rounding);
  const TrajectoryError scaled = evaluateTrajectory(estimate, truth, {.alignment = AlignmentGroup::sim3});
  EXPECT_NEAR(scaled.alignment.scale, 0.5, rounding);
  EXPECT_NEAR(scaled.absoluteTranslation.largest, 0.0, rounding);
}

TEST(TrajectoryError, RigidMotionOfEitherSideChangesNothing) {
  const Trajectory truth = randomWalk(1, 60);
  const Trajectory estimate = randomWalk(2, 60);
  for (const AlignmentGroup group : {AlignmentGroup::se3, AlignmentGroup::sim3}) {
    const EvaluationOptions options{.alignment = group};
    const TrajectoryError plain = evaluateTrajectory(estimate, truth, options);
    for (const TrajectoryError& other : {evaluateTrajectory(moved(someMotion(), estimate), truth, options),
                                         evaluateTrajectory(estimate, moved(someMotion(), truth), options)}) {
      EXPECT_NEAR(other.absoluteTranslation.rootMeanSquare, plain.absoluteTranslation.rootMeanSquare, rounding);
      EXPECT_NEAR(other.absoluteRotation.mean, plain.absoluteRotation.mean, rounding);
      EXPECT_NEAR(other.relativeTranslation.rootMeanSquare, plain.relativeTranslation.rootMeanSquare, rounding);
      EXPECT_NEAR(other.relativeRotation.largest, plain.relativeRotation.largest, rounding);
    }
  }
  const TrajectoryError none =
      evaluateTrajectory(moved(someMotion(), truth, 2.5), truth, {.alignment = AlignmentGroup::sim3});
  EXPECT_NEAR(none.absoluteTranslation.largest, 0.0, 1e-11);
  EXPECT_NEAR(none.absoluteRotation.largest, 0.0, 1e-7);  // the angle of a quaternion product near one
  EXPECT_NEAR(none.alignment.scale, 0.4, rounding);
}

TEST(TrajectoryError, StepsInMetres) {
  const Trajectory truth = along({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {6, 0, 0}, {8, 0, 0}});
  const Trajectory estimate = along({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {6, 0, 1}, {8, 0, 1}});
  const TrajectoryError error =
      evaluateTrajectory(estimate, truth, {.alignment = AlignmentGroup::none, .step = 3.0, .stepInMetres = true});
  EXPECT_EQ(error.relativeTranslation.count, 3);  // 0-2, 1-3, 2-4
  EXPECT_DOUBLE_EQ(error.relativeTranslation.mean, 2.0 / 3.0);
}

TEST(TrajectoryError, MatchesIdsAndStamps) {
  Trajectory truth = along({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  Trajectory estimate = along({{9, 0, 0}, {1, 0, 0}, {3, 0, 0}});
  truth.key = estimate.key = TrajectoryKey::id;
  estimate.poses[0].key = -1;
  estimate.poses[2].key = 3;
  EXPECT_EQ(evaluateTrajectory(estimate, truth, {.alignment = AlignmentGroup::none}).absoluteTranslation.largest, 0.0);
  truth.key = estimate.key = TrajectoryKey::stamp;
  estimate.poses[1].key = 1.004;
  estimate.poses[2].key = 3.02;
  EXPECT_EQ(evaluateTrajectory(estimate, truth).matched, 1);
  EXPECT_EQ(evaluateTrajectory(estimate, truth, {.stampTolerance = 0.05}).matched, 2);
  EXPECT_THROW(evaluateTrajectory(estimate, truth, {.stampTolerance = 0.001}), GraphError);
  EXPECT_THROW(evaluateTrajectory(estimate, truth, {.matching = PoseMatching::order}), GraphError);
  EXPECT_THROW(evaluateTrajectory(estimate, truth, {.matching = PoseMatching::id}), GraphError);
  EXPECT_THROW(evaluateTrajectory(truth, truth, {.step = 0.5}), GraphError);
  EXPECT_THROW(evaluateTrajectory(truth, truth, {.alignment = AlignmentGroup::se2}), GraphError);
}

TEST(TrajectoryError, PosesOfAGraph) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE2>(5, SE2<double>(1.0, 2.0, 0.3));
  graph.addVertex<VertexSE2>(2, SE2<double>(4.0, 5.0, -0.3));
  graph.addVertex<VertexXY>(1, Vector<double, 2>(0.0, 0.0));
  const Trajectory trajectory = trajectoryOf(graph);
  ASSERT_EQ(trajectory.poses.size(), 2u);
  EXPECT_TRUE(trajectory.planar);
  EXPECT_EQ(trajectory.poses[0].key, 2.0);
  EXPECT_EQ(trajectory.poses[0].pose.translation(), Vector3(4.0, 5.0, 0.0));
  EXPECT_NEAR(trajectory.poses[1].pose.rotation().log()[2], 0.3, rounding);
  const TrajectoryError error = evaluateTrajectory(trajectory, trajectory, {.alignment = AlignmentGroup::se2});
  EXPECT_NEAR(error.absoluteTranslation.largest, 0.0, rounding);
  graph.addVertex<VertexSE2>(9);
  EXPECT_THROW(trajectoryOf(graph), GraphError);
  EXPECT_THROW(trajectoryOf(Graph(builtinRegistry())), GraphError);
}

TEST(TrajectoryError, StepsBeyondTheEndAreRefused) {
  const Trajectory truth = along({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}});
  const auto count = [&](double step, bool metres) {
    return evaluateTrajectory(truth, truth, {.step = step, .stepInMetres = metres}).relativeTranslation.count;
  };
  EXPECT_EQ(count(2.0, false), 1);
  EXPECT_THROW(count(3.0, false), GraphError);
  EXPECT_THROW(count(1e9, false), GraphError);
  EXPECT_EQ(count(3.0, true), 1);
  EXPECT_THROW(count(3.01, true), GraphError);
  const Trajectory single = along({{1, 2, 3}});
  EXPECT_EQ(evaluateTrajectory(single, single).relativeTranslation.count, 0);
  EXPECT_THROW(evaluateTrajectory(single, single, {.step = 2.0}), GraphError);
}

TEST(TrajectoryError, TellsHowPosesWereMatched) {
  const Trajectory truth = along({{0, 0, 0}, {1, 0, 0}});
  Trajectory ids = truth;
  ids.key = TrajectoryKey::id;
  EXPECT_EQ(evaluateTrajectory(truth, truth).matching, PoseMatching::order);
  EXPECT_EQ(evaluateTrajectory(ids, ids).matching, PoseMatching::id);
  EXPECT_EQ(nameOf(PoseMatching::id), "id");
}

/// A mast that stands where its foot is, five metres high.
class VertexMast : public BaseVertex<VertexMast, 2, Vector<double, 2>> {
 public:
  static Vector<double, 2> oplus(const Vector<double, 2>& x, const Vector<double, 2>& delta) { return x + delta; }
  static Pose place(const Vector<double, 2>& x) { return Pose(SO3<double>(), Vector3(x[0], x[1], 5.0)); }
};

TEST(TrajectoryError, KnowsPosesOfOwnTypesByTheirPlace) {
  const auto registry = builtinRegistry();
  const VertexType& mast = registry->addVertex<VertexMast>("VERTEX_MAST");
  EXPECT_EQ(mast.placeKind(), PlaceKind::pose);
  EXPECT_EQ(registry->findVertexType("VERTEX_XY")->placeKind(), PlaceKind::planarPoint);
  EXPECT_EQ(registry->findVertexType("VERTEX_TRACKXYZ")->placeKind(), PlaceKind::point);
  EXPECT_EQ(registry->findVertexType("VERTEX_SE2")->placeKind(), PlaceKind::planarPose);
  EXPECT_EQ(registry->findVertexType("VERTEX_CAMERA:BAL")->placeKind(), PlaceKind::pose);
  Graph graph(registry);
  graph.addVertex<VertexXY>(0, Vector<double, 2>(3.0, 4.0));
  EXPECT_THROW(trajectoryOf(graph), GraphError) << "points are no poses";
  graph.addVertex<VertexMast>(1, Vector<double, 2>(3.0, 4.0));
  const Trajectory trajectory = trajectoryOf(graph);
  ASSERT_EQ(trajectory.poses.size(), 1u);
  EXPECT_FALSE(trajectory.planar);
  EXPECT_EQ(trajectory.poses[0].pose.translation(), Vector3(3.0, 4.0, 5.0));
}

}  // namespace
}  // namespace quiver
