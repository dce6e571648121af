// Trajectory files, good and malformed, with the message that says what is wrong.
#include <string>

#include <gtest/gtest.h>

#include <quiver/core/util/error.h>
#include <quiver/evaluation/trajectory.h>

namespace quiver {
namespace {

struct Malformed {
  const char* name;
  std::string text;
  std::string message;
};
void PrintTo(const Malformed& malformed, std::ostream* out) { *out << malformed.name; }

const std::string good = "1 0 0 0 0 0 0 1\n";

std::vector<Malformed> malformed() {
  return {
      {"Empty", "", "t.txt:1:1: no pose in the whole trajectory"},
      {"CommentsOnly", "# a\n\n# b\n", "t.txt:1:1: no pose in the whole trajectory"},
      {"SevenNumbers", "1 2 3 4 5 6 7\n", "t.txt:1:1: 7 numbers: a line of a trajectory has 8 (TUM) or 12 (KITTI)"},
      {"ThirteenNumbers", "1 2 3 4 5 6 7 8 9 10 11 12 13\n",
       "t.txt:1:28: a line of a trajectory has 8 numbers (TUM) or 12 (KITTI)"},
      {"Word", good + "2 0 0 zero 0 0 0 1\n", "t.txt:2:7: 'zero' is not a number"},
      {"LongerThanBefore", good + "2 0 0 0 0 0 0 1 5\n", "t.txt:2:17: 9 numbers, where the lines before have 8"},
      {"StampTwice", good + "1 0 0 0 0 0 0 1\n", "t.txt:2:1: time stamps must ascend"},
      {"StampFalls", good + "# c\n 0.5 0 0 0 0 0 0 1\n", "t.txt:3:2: time stamps must ascend"},
      {"ZeroQuaternion", "1 0 0 0 0 0 0 0\n", "t.txt:1:9: the quaternion has length 0, not 1"},
      {"LongQuaternion", good + "2 0 0 0 0 0 1 1\n", "t.txt:2:9: the quaternion has length 1.41421, not 1"},
      {"KittiScaled", "2 0 0 0 0 1 0 0 0 0 1 0\n", "t.txt:1:1: the first three columns are no rotation"},
      {"KittiMirrored", "1 0 0 0 0 1 0 0 0 0 -1 0\n", "t.txt:1:1: the first three columns are no rotation"},
  };
}

class MalformedTrajectory : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedTrajectory, IsRefusedByPlace) {
  try {
    readTrajectoryText(GetParam().text, "t.txt");
    FAIL() << "was read";
  } catch (const ParseError& error) {
    EXPECT_EQ(error.what(), GetParam().message);
  }
}

INSTANTIATE_TEST_SUITE_P(All, MalformedTrajectory, testing::ValuesIn(malformed()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(TrajectoryReader, ReadsBothFormats) {
  const Trajectory tum = readTrajectoryText("# stamp x y z q\n1.5 1 2 3 0 0 0.6 0.8\r\n\n2.5 4 5 6 0 0 0 -1", "t");
  ASSERT_EQ(tum.poses.size(), 2u);
  EXPECT_EQ(tum.key, TrajectoryKey::stamp);
  EXPECT_EQ(tum.poses[0].key, 1.5);
  EXPECT_EQ((tum.poses[0].pose.translation()), (Vector<double, 3>(1, 2, 3)));
  EXPECT_NEAR(tum.poses[0].pose.rotation().z(), 0.6, 1e-15);
  const Trajectory kitti = readTrajectoryText("0 -1 0 7 1 0 0 8 0 0 1 9\n1 0 0 0 0 1 0 0 0 0 1 0\n", "t");
  ASSERT_EQ(kitti.poses.size(), 2u);
  EXPECT_EQ(kitti.key, TrajectoryKey::order);
  EXPECT_EQ((kitti.poses[0].pose.translation()), (Vector<double, 3>(7, 8, 9)));
  const Vector<double, 3> image = kitti.poses[0].pose.rotation() * Vector<double, 3>(1, 0, 0);
  EXPECT_NEAR((image - Vector<double, 3>(0, 1, 0)).norm(), 0.0, 1e-15);
}

TEST(TrajectoryReader, KnowsATrajectoryWhenItSeesOne) {
  EXPECT_TRUE(isTrajectoryText("# c\n1.0 2"));
  EXPECT_FALSE(isTrajectoryText("VERTEX_SE2 0 0 0 0"));
  EXPECT_FALSE(isTrajectoryText(""));
  EXPECT_TRUE(isTrajectoryText("1 2 x"));
  EXPECT_TRUE(
      isTrajectoryText("\xef\xbb\xbf"
                       "0 0 0 0 0 0 0 1"));
  EXPECT_EQ(readTrajectoryText("\xef\xbb\xbf"
                               "0 0 0 0 0 0 0 1",
                               "t")
                .poses.size(),
            1u);
  EXPECT_TRUE(isTrajectoryText("1 2 3.5\n"));
  EXPECT_FALSE(isTrajectoryText("49 7776 31843\n0 0 1.5 -2\n")) << "a bundle adjustment file";
}

}  // namespace
}  // namespace quiver
