#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <quiver/core/util/error.h>
#include <quiver/evaluation/alignment.h>
#include <quiver/geometry/sim3.h>
#include <quiver/geometry/so3.h>

namespace quiver {
namespace {

using Vector3 = Vector<double, 3>;
using Points = std::vector<Vector3>;

Points randomPoints(unsigned seed, int count, double height) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-5.0, 5.0);
  Points points;
  for (int i = 0; i < count; ++i) points.emplace_back(uniform(engine), uniform(engine), height * uniform(engine));
  return points;
}

double costOf(const Alignment& alignment, const Points& from, const Points& to) {
  double cost = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) cost += (to[i] - alignment * from[i]).squaredNorm();
  return cost;
}

/// One of the four coordinates of a turn about an axis, a scale or a shift.
Alignment nudged(const Alignment& a, int coordinate, double size, AlignmentGroup group) {
  Alignment b = a;
  if (coordinate < 3) {
    if (group == AlignmentGroup::se2 && coordinate != 2) return a;
    Vector3 turn = Vector3::Zero();
    turn[coordinate] = size;
    b.rotation = SO3<double>::exp(turn).matrix() * a.rotation;
  } else if (coordinate < 6) {
    if (group == AlignmentGroup::se2 && coordinate == 5) return a;
    b.translation[coordinate - 3] += size;
  } else if (group == AlignmentGroup::sim3) {
    b.scale *= 1.0 + size;
  }
  return b;
}

/// The slow twin: from many starts, a search along one coordinate after the other with halved steps.
double leastCostBySearch(const Points& from, const Points& to, AlignmentGroup group) {
  double best = INFINITY;
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-3.1, 3.1);
  for (int start = 0; start < 20; ++start) {
    Alignment a;
    const Vector3 turn(group == AlignmentGroup::se2 ? 0.0 : uniform(engine),
                       group == AlignmentGroup::se2 ? 0.0 : uniform(engine), uniform(engine));
    a.rotation = SO3<double>::exp(turn).matrix();
    double cost = costOf(a, from, to);
    for (double size = 1.0; size > 1e-9;) {
      bool better = false;
      for (int coordinate = 0; coordinate < 7; ++coordinate) {
        for (const double sign : {-1.0, 1.0}) {
          const Alignment b = nudged(a, coordinate, sign * size, group);
          if (const double c = costOf(b, from, to); c < cost) {
            a = b;
            cost = c;
            better = true;
          }
        }
      }
      if (!better) size *= 0.5;
    }
    best = std::min(best, cost);
  }
  return best;
}

TEST(Alignment, AgreesWithASearch) {
  const Points from = randomPoints(1, 12, 0.7);
  Points to = randomPoints(2, 12, 0.7);
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = 0.4 * to[i] + Vector3(from[i][1], -from[i][0], from[i][2]) * 1.7;
  for (const AlignmentGroup group : {AlignmentGroup::se3, AlignmentGroup::sim3}) {
    const Alignment alignment = alignPoints(from, to, group);
    const double least = leastCostBySearch(from, to, group);
    EXPECT_TRUE(alignment.unique);
    EXPECT_NEAR(costOf(alignment, from, to), least, 1e-6 * least) << nameOf(group);
    EXPECT_LE(costOf(alignment, from, to), least * (1.0 + 1e-12));
  }
}

TEST(Alignment, InThePlaneAgreesWithASearch) {
  const Points from = randomPoints(3, 10, 0.0), to = randomPoints(4, 10, 0.0);
  const Alignment alignment = alignPoints(from, to, AlignmentGroup::se2);
  const double least = leastCostBySearch(from, to, AlignmentGroup::se2);
  EXPECT_NEAR(costOf(alignment, from, to), least, 1e-6 * least);
  EXPECT_EQ(alignment.scale, 1.0);
}

TEST(Alignment, IsNeverAMirrorImage) {
  Points from = randomPoints(5, 9, 1.0), to = from;
  for (Vector3& p : to) p[2] = -p[2];
  for (const AlignmentGroup group : {AlignmentGroup::se3, AlignmentGroup::sim3})
    EXPECT_NEAR(alignPoints(from, to, group).rotation.determinant(), 1.0, 1e-12);
}

TEST(Alignment, SaysWhenPointsLieOnALine) {
  const Points line{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}};
  const Alignment alignment = alignPoints(line, line, AlignmentGroup::se3);
  EXPECT_FALSE(alignment.unique);
  EXPECT_NEAR(costOf(alignment, line, line), 0.0, 1e-24);
  const Points point{{1, 2, 0}};
  EXPECT_FALSE(alignPoints(point, point, AlignmentGroup::se2).unique);
  EXPECT_EQ(alignPoints(point, Points{{4, 4, 0}}, AlignmentGroup::sim3).scale, 1.0);
  EXPECT_THROW(alignPoints(point, line, AlignmentGroup::se3), GraphError);
  EXPECT_THROW(alignPoints({}, {}, AlignmentGroup::se3), GraphError);
}

}  // namespace
}  // namespace quiver
