#include <array>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <quiver/core/io/text/source_text.h>
#include <quiver/core/io/text/text_scanner.h>
#include <quiver/evaluation/trajectory.h>

namespace quiver {
namespace {

using detail::SourceText;

constexpr int tumNumbers = 8;
constexpr int kittiNumbers = 12;
constexpr int mostNumbers = kittiNumbers;

/// The numbers of one line and where each stands.
struct Row {
  std::array<double, mostNumbers> values{};
  std::array<const char*, mostNumbers> places{};
  int count = 0;
};

Row readRow(TextScanner& scanner, const SourceText& source) {
  Row row;
  while (!scanner.atLineEnd()) {
    const char* const place = scanner.cursor();
    if (row.count == mostNumbers) throw source.error(place, "a line of a trajectory has 8 numbers (TUM) or 12 (KITTI)");
    double value = 0.0;
    const NumberStatus status = scanner.real(value);
    if (status != NumberStatus::ok) throw source.badNumber(place, status, false);
    row.places[static_cast<std::size_t>(row.count)] = place;
    row.values[static_cast<std::size_t>(row.count++)] = value;
  }
  return row;
}

TrajectoryPose tumPose(const Row& row, const SourceText& source) {
  constexpr double tolerance = 1e-2;
  const auto& v = row.values;
  const double norm = std::sqrt(v[4] * v[4] + v[5] * v[5] + v[6] * v[6] + v[7] * v[7]);
  if (!(std::abs(norm - 1.0) <= tolerance))
    throw source.error(row.places[4], fmt::format("the quaternion has length {:g}, not 1", norm));
  return {v[0], SE3<double>(v[1], v[2], v[3], v[4] / norm, v[5] / norm, v[6] / norm, v[7] / norm)};
}

TrajectoryPose kittiPose(const Row& row, double order, const SourceText& source) {
  constexpr double tolerance = 1e-3;
  const auto& v = row.values;
  Eigen::Matrix3d R;
  R << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
  if (!((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() <= tolerance) || R.determinant() < 0.0)
    throw source.error(row.places[0], "the first three columns are no rotation");
  const Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  return {order, SE3<double>(v[3], v[7], v[11], q.x(), q.y(), q.z(), q.w())};
}

/// The text behind a byte order mark.
std::string_view withoutMark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

bool isComment(TextScanner& scanner) { return scanner.atLineEnd() || *scanner.cursor() == '#'; }

}  // namespace

bool isTrajectoryText(std::string_view text) {
  TextScanner scanner(withoutMark(text));
  while (!scanner.atEnd()) {
    if (!isComment(scanner)) {
      int numbers = 0;
      bool whole = true;
      double value = 0.0;
      while (!scanner.atLineEnd() && scanner.real(value) == NumberStatus::ok) {
        ++numbers;
        whole = whole && value == std::floor(value);
      }
      return numbers > 0 && !(numbers == 3 && whole && scanner.atLineEnd());
    }
    scanner.nextLine();
  }
  return false;
}

Trajectory readTrajectoryText(std::string_view text, const std::string& name) {
  const SourceText source{text, name};
  TextScanner scanner(withoutMark(text));
  Trajectory trajectory;
  int width = 0;
  while (!scanner.atEnd()) {
    if (isComment(scanner)) {
      scanner.nextLine();
      continue;
    }
    const Row row = readRow(scanner, source);
    if (width == 0 && (row.count == tumNumbers || row.count == kittiNumbers)) width = row.count;
    if (width == 0)
      throw source.error(row.places[0],
                         fmt::format("{} numbers: a line of a trajectory has 8 (TUM) or 12 (KITTI)", row.count));
    if (row.count < width)
      throw source.endsEarly(row.places[0], fmt::format("{} of {} numbers are", width - row.count, width));
    if (row.count > width)
      throw source.error(row.places[static_cast<std::size_t>(width)],
                         fmt::format("{} numbers, where the lines before have {}", row.count, width));
    const TrajectoryPose pose = width == tumNumbers
                                    ? tumPose(row, source)
                                    : kittiPose(row, static_cast<double>(trajectory.poses.size()), source);
    if (!trajectory.poses.empty() && !(pose.key > trajectory.poses.back().key))
      throw source.error(row.places[0], "time stamps must ascend");
    trajectory.poses.push_back(pose);
    scanner.nextLine();
  }
  if (trajectory.poses.empty()) throw source.error(source.begin(), "no pose in the whole trajectory");
  trajectory.key = width == tumNumbers ? TrajectoryKey::stamp : TrajectoryKey::order;
  return trajectory;
}

}  // namespace quiver
