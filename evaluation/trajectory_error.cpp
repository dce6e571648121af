#include <quiver/evaluation/trajectory_error.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <quiver/core/util/error.h>

namespace quiver {
namespace {

using Pose = SE3<double>;
using Pair = std::pair<std::size_t, std::size_t>;
using Pairs = std::vector<Pair>;

PoseMatching chooseMatching(const Trajectory& estimate, const Trajectory& truth, PoseMatching wanted) {
  if (wanted != PoseMatching::automatic) return wanted;
  if (estimate.key != truth.key || estimate.key == TrajectoryKey::order) return PoseMatching::order;
  return estimate.key == TrajectoryKey::id ? PoseMatching::id : PoseMatching::stamp;
}

Pairs matchByOrder(const Trajectory& estimate, const Trajectory& truth) {
  if (estimate.poses.size() != truth.poses.size())
    throw GraphError(
        fmt::format("the trajectories have {} and {} poses, so their order does not tell which belong together",
                    estimate.poses.size(), truth.poses.size()));
  Pairs pairs;
  for (std::size_t i = 0; i < truth.poses.size(); ++i) pairs.emplace_back(i, i);
  return pairs;
}

/// Both sides ascend, so nearest neighbours are found by one pass; the nearest of two claims on a truth wins.
Pairs matchByKey(const Trajectory& estimate, const Trajectory& truth, double tolerance) {
  Pairs pairs;
  std::size_t j = 0;
  const auto distance = [&](std::size_t i, std::size_t k) {
    return std::abs(estimate.poses[i].key - truth.poses[k].key);
  };
  for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
    while (j + 1 < truth.poses.size() && distance(i, j + 1) <= distance(i, j)) ++j;
    if (distance(i, j) > tolerance) continue;
    if (pairs.empty() || pairs.back().second != j) {
      pairs.emplace_back(i, j);
    } else if (distance(i, j) < distance(pairs.back().first, j)) {
      pairs.back().first = i;
    }
  }
  return pairs;
}

/// `matching` is not automatic.
Pairs matchPoses(const Trajectory& estimate, const Trajectory& truth, PoseMatching matching, double stampTolerance) {
  if (matching == PoseMatching::order) return matchByOrder(estimate, truth);
  const TrajectoryKey key = matching == PoseMatching::id ? TrajectoryKey::id : TrajectoryKey::stamp;
  if (estimate.key != key || truth.key != key)
    throw GraphError(fmt::format("poses cannot be matched by {}: not both trajectories have them", nameOf(matching)));
  const Pairs pairs = matchByKey(estimate, truth, matching == PoseMatching::id ? 0.0 : stampTolerance);
  if (pairs.empty()) throw GraphError("no pose of the estimate has a counterpart in the truth");
  return pairs;
}

Pose aligned(const Alignment& alignment, const Pose& pose) {
  const Eigen::Quaterniond q(alignment.rotation);
  return Pose(SO3<double>(q.x(), q.y(), q.z(), q.w()) * pose.rotation(), alignment * pose.translation());
}

Pairs stepsInPoses(std::size_t poses, double step) {
  Pairs pairs;
  if (step >= static_cast<double>(poses)) {
    if (step > 1.0)
      throw GraphError(fmt::format("a step of {:g} poses goes beyond the end: {} {}", step, poses,
                                   poses == 1 ? "pose is matched" : "poses are matched"));
    return pairs;
  }
  const auto distance = static_cast<std::size_t>(step);
  for (std::size_t i = 0; i + distance < poses; ++i) pairs.emplace_back(i, i + distance);
  return pairs;
}

Pairs stepsInMetres(const std::vector<Pose>& truth, double step) {
  std::vector<double> travelled(truth.size(), 0.0);
  for (std::size_t i = 1; i < truth.size(); ++i)
    travelled[i] = travelled[i - 1] + (truth[i].translation() - truth[i - 1].translation()).norm();
  if (step > travelled.back())
    throw GraphError(fmt::format("a step of {:g} m goes beyond the end: the matched part of the truth is {:.6g} m long",
                                 step, travelled.back()));
  Pairs pairs;
  std::size_t j = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    while (j < truth.size() && travelled[j] - travelled[i] < step) ++j;
    if (j == truth.size()) break;
    pairs.emplace_back(i, j);
  }
  return pairs;
}

/// For every pose the index of its partner, as long as there is one.
Pairs steps(const std::vector<Pose>& truth, const EvaluationOptions& options) {
  return options.stepInMetres ? stepsInMetres(truth, options.step) : stepsInPoses(truth.size(), options.step);
}

void checkOptions(const EvaluationOptions& options) {
  if (!(options.step > 0.0) || !std::isfinite(options.step) ||
      (!options.stepInMetres && (options.step < 1.0 || options.step != std::floor(options.step))))
    throw GraphError(fmt::format("a step of {:g} is neither a length nor a number of poses", options.step));
  if (!(options.stampTolerance >= 0.0)) throw GraphError("the largest difference of stamps must not be negative");
}

}  // namespace

ErrorStatistics statisticsOf(std::vector<double> errors) {
  ErrorStatistics result;
  if (errors.empty()) return result;
  std::sort(errors.begin(), errors.end());
  const std::size_t n = errors.size();
  double sum = 0.0;
  double squares = 0.0;
  for (const double error : errors) {
    sum += error;
    squares += error * error;
  }
  result.count = static_cast<std::int64_t>(n);
  result.mean = sum / static_cast<double>(n);
  result.rootMeanSquare = std::sqrt(squares / static_cast<double>(n));
  result.median = 0.5 * (errors[(n - 1) / 2] + errors[n / 2]);
  double spread = 0.0;
  for (const double error : errors) spread += (error - result.mean) * (error - result.mean);
  result.deviation = std::sqrt(spread / static_cast<double>(n));
  result.least = errors.front();
  result.largest = errors.back();
  return result;
}

TrajectoryError evaluateTrajectory(const Trajectory& estimate, const Trajectory& truth,
                                   const EvaluationOptions& options) {
  checkOptions(options);
  if (options.alignment == AlignmentGroup::se2 && !(estimate.planar && truth.planar))
    throw GraphError("an alignment in the plane needs two trajectories in the plane");
  TrajectoryError result;
  result.matching = chooseMatching(estimate, truth, options.matching);
  const Pairs pairs = matchPoses(estimate, truth, result.matching, options.stampTolerance);
  std::vector<Vector<double, 3>> from, to;
  for (const auto& [i, j] : pairs) {
    from.push_back(estimate.poses[i].pose.translation());
    to.push_back(truth.poses[j].pose.translation());
  }
  result.matched = static_cast<std::int64_t>(pairs.size());
  result.alignment = alignPoints(from, to, options.alignment);
  std::vector<double> translations, rotations;
  for (const auto& [i, j] : pairs) {
    result.estimate.push_back(aligned(result.alignment, estimate.poses[i].pose));
    result.truth.push_back(truth.poses[j].pose);
    const Pose& p = result.estimate.back();
    const Pose& q = result.truth.back();
    translations.push_back((q.translation() - p.translation()).norm());
    rotations.push_back((q.rotation().inverse() * p.rotation()).log().norm());
  }
  result.absoluteTranslation = statisticsOf(std::move(translations));
  result.absoluteRotation = statisticsOf(std::move(rotations));
  translations.clear();
  rotations.clear();
  for (const auto& [i, j] : steps(result.truth, options)) {
    const Pose error = result.truth[i].between(result.truth[j]).between(result.estimate[i].between(result.estimate[j]));
    translations.push_back(error.translation().norm());
    rotations.push_back(error.rotation().log().norm());
  }
  result.relativeTranslation = statisticsOf(std::move(translations));
  result.relativeRotation = statisticsOf(std::move(rotations));
  return result;
}

std::string_view nameOf(PoseMatching matching) {
  constexpr std::string_view names[] = {"auto", "id", "stamp", "order"};
  return names[static_cast<int>(matching)];
}

}  // namespace quiver
