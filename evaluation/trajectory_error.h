#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include <quiver/evaluation/alignment.h>
#include <quiver/evaluation/trajectory.h>

namespace quiver {

/// Which poses of two trajectories belong together.
enum class PoseMatching {
  /// By id for two graphs, by stamp where both have stamps, else by order.
  automatic,
  id,
  /// Each stamp of the estimate and the nearest one of the truth, if they are near enough; no truth twice.
  stamp,
  /// The first with the first and so on; the numbers of poses must be equal.
  order,
};

struct EvaluationOptions {
  AlignmentGroup alignment = AlignmentGroup::se3;
  PoseMatching matching = PoseMatching::automatic;
  /// Largest difference of matched stamps [s].
  double stampTolerance = 0.01;
  /// Relative errors compare poses this far apart: in matched poses, or in metres along the truth if `stepInMetres`.
  double step = 1.0;
  bool stepInMetres = false;
};

/// Of a list of errors ≥ 0. All zero for an empty list.
struct ErrorStatistics {
  std::int64_t count = 0;
  double rootMeanSquare = 0.0;
  double mean = 0.0;
  double median = 0.0;
  /// √(mean square − mean²).
  double deviation = 0.0;
  double least = 0.0;
  double largest = 0.0;
};

struct TrajectoryError {
  std::int64_t matched = 0;
  /// How they were; not automatic.
  PoseMatching matching = PoseMatching::order;
  Alignment alignment;
  /// ‖t_truth − A t_estimate‖ [m] and the angle of R_truthᵀ R_A R_estimate [rad], one a matched pose.
  ErrorStatistics absoluteTranslation;
  ErrorStatistics absoluteRotation;
  /// Of (Q_i⁻¹ Q_j)⁻¹ P_i⁻¹ P_j, Q the truth and P the aligned estimate: ‖t‖ [m] and the angle [rad], one a pair.
  ErrorStatistics relativeTranslation;
  ErrorStatistics relativeRotation;
  /// Matched poses in order: the aligned estimate and the truth.
  std::vector<SE3<double>> estimate;
  std::vector<SE3<double>> truth;
};

/// Absolute and relative trajectory error after alignment. The relative one does not depend on a rigid alignment, only
/// on its scale; of a single matched pose there is none at the step of one pose. Throws GraphError if nothing matches,
/// if no two matched poses are as far apart as any other step says, or if the options do not fit the trajectories.
/// O(n log n).
TrajectoryError evaluateTrajectory(const Trajectory& estimate, const Trajectory& truth,
                                   const EvaluationOptions& options = {});

ErrorStatistics statisticsOf(std::vector<double> errors);

/// "auto", "id", "stamp", "order".
std::string_view nameOf(PoseMatching matching);

}  // namespace quiver
