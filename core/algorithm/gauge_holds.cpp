#include <quiver/core/algorithm/gauge_holds.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace quiver::detail {
namespace {

/// Combinations that span the same motions, each of mean square 1 over `scalars` tangent directions; those that move
/// nothing are left out.
GaugeCombinations independent(const GaugeCombinations& combinations, const GaugeProducts& gram, double scalars) {
  // Each is brought to the same length of motion first, lest rounding decide which are left out.
  const Eigen::VectorXd lengths = (combinations.transpose() * gram * combinations).diagonal().cwiseSqrt();
  GaugeCombinations even = combinations;
  for (Eigen::Index i = 0; i < even.cols(); ++i) {
    if (lengths[i] > 0.0) even.col(i) /= lengths[i];
  }
  const Eigen::MatrixXd products = even.transpose() * gram * even;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(products);
  const double largest = eigen.eigenvalues().size() > 0 ? eigen.eigenvalues().maxCoeff() : 0.0;
  GaugeCombinations result(gaugeDirections, 0);
  for (Eigen::Index i = 0; i < eigen.eigenvalues().size(); ++i) {
    if (!(eigen.eigenvalues()[i] > 1e-13 * largest)) continue;
    result.conservativeResize(Eigen::NoChange, result.cols() + 1);
    result.col(result.cols() - 1) = even * eigen.eigenvectors().col(i) * std::sqrt(scalars / eigen.eigenvalues()[i]);
  }
  return result;
}

/// Directions of one variable that the combinations move, at most `most` and independent of each other; the
/// combinations that are left do not move them. Those that turn alone come first: a turn of the world turns a pose
/// wherever it stands, while which way it pushes the pose changes with every step. `reach` is how far a turn of 1
/// radian moves a vertex on average: turns are measured by it, since radians do not grow with the world.
std::uint64_t chooseDirections(const Eigen::MatrixXd& generators, int most, double reach,
                               GaugeCombinations& combinations) {
  constexpr double leastMotion = 1e-6;  // of the mean
  std::uint64_t directions = 0;
  for (int taken = 0; taken < most && combinations.cols() > 0; ++taken) {
    const Eigen::MatrixXd motion = generators * combinations;
    const Eigen::VectorXd lengths = motion.rowwise().norm();
    const Eigen::VectorXd turns =
        (generators.leftCols(gaugeRoll).rowwise().norm().array() == 0.0).select(reach * lengths, 0.0);
    Eigen::Index row = 0;
    if (!(turns.maxCoeff(&row) > leastMotion) && !(lengths.maxCoeff(&row) > leastMotion)) break;
    if (row >= 64) break;
    directions |= std::uint64_t{1} << row;
    // Rotates the combinations so that the first alone moves this direction, and drops it.
    const Eigen::HouseholderQR<Eigen::MatrixXd> turn(motion.row(row).transpose());
    const Eigen::MatrixXd turned = combinations * turn.householderQ();
    combinations = turned.rightCols(turned.cols() - 1);
  }
  return directions;
}

}  // namespace

std::vector<HeldDirections> chooseHolds(const Problem& problem, const ComponentGauge& gauge, const GaugeProducts& gram,
                                        const GaugeCombinations& free, const std::vector<double>& generators,
                                        const std::vector<std::int64_t>& begin) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, gaugeDirections, Eigen::RowMajor>;
  double scalars = 0.0;
  for (const int v : gauge.variables) scalars += problem.dimension(v);
  const double turned = gram.diagonal().segment<gaugeScale - gaugeRoll>(gaugeRoll).maxCoeff();
  const double reach = std::sqrt(turned / static_cast<double>(gauge.variables.size()));
  GaugeCombinations left = independent(free, gram, scalars);
  int need = gauge.free;
  std::vector<HeldDirections> holds;
  const auto hold = [&](int variable) {
    const int dimension = problem.dimension(variable);
    const Eigen::Map<const Rows, 0, Eigen::OuterStride<gaugeRow>> G(
        generators.data() + begin[static_cast<std::size_t>(problem.slotOfVariable(variable))], dimension,
        gaugeDirections);
    const std::uint64_t directions = chooseDirections(G, std::min(need, dimension), reach, left);
    if (directions == 0) return;
    holds.push_back({variable, directions});
    need -= std::popcount(directions);
  };
  hold(gauge.anchor);
  for (std::size_t i = 0; i < gauge.variables.size() && need > 0; ++i) {
    if (gauge.variables[i] != gauge.anchor) hold(gauge.variables[i]);
  }
  return holds;
}

}  // namespace quiver::detail
