#include <quiver/initialization/chordal.h>

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <quiver/core/graph/estimates.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/parallel.h>
#include <quiver/core/util/stop_condition.h>
#include <quiver/initialization/pose_graph.h>
#include <quiver/initialization/propagation.h>
#include <quiver/solvers/backends/block_solver.h>
#include <quiver/solvers/block/ordering.h>

namespace quiver {
namespace {

/// A symmetric block system over the poses that are not held, all blocks of one dimension, in elimination order.
class PoseSystem {
 public:
  /// `order` is reused if it is not empty, else chosen and returned there.
  template <int D>
  PoseSystem(const PoseGraph<D>& poses, int dimension, int threads, std::vector<int>& order) : dimension_(dimension) {
    std::vector<int> free(poses.vertices.size(), -1);
    int count = 0;
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (!poses.held[i]) free[i] = count++;
    }
    std::vector<std::pair<int, int>> pairs;
    for (const auto& edge : poses.edges) {
      const int a = free[static_cast<std::size_t>(edge.from)];
      const int b = free[static_cast<std::size_t>(edge.to)];
      if (a >= 0 && b >= 0) pairs.emplace_back(a, b);
    }
    const BlockPattern natural =
        BlockPattern::fromPairs(BlockLayout(std::vector<int>(static_cast<std::size_t>(count), dimension)), pairs);
    solver_ = makeBlockSolver();
    // One factorisation does not pay for a search for the best order.
    if (order.empty()) order = amdOrdering(natural).order;
    std::vector<int> place(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) place[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = i;
    position_.resize(free.size());
    for (std::size_t i = 0; i < free.size(); ++i)
      position_[i] = free[i] < 0 ? -1 : place[static_cast<std::size_t>(free[i])];
    const auto pattern = std::make_shared<const BlockPattern>(natural.permuted(order));
    matrix_ = BlockMatrix(pattern);
    solver_->analyze(pattern, threads);
    right_.assign(static_cast<std::size_t>(count) * static_cast<std::size_t>(dimension * D), 0.0);
  }

  /// Block of a pose in elimination order; −1 if it is held.
  int position(int pose) const { return position_[static_cast<std::size_t>(pose)]; }

  void addDiagonal(int block, double weight) {
    double* values = matrix_.block(matrix_.pattern().columnBegin(block));
    for (int i = 0; i < dimension_; ++i) values[i * (dimension_ + 1)] += weight;
  }
  /// Adds `values(r, c)` to the entry of (row block, column block), in whichever triangle it is stored.
  template <typename Values>
  void addOffDiagonal(int row, int column, const Values& values) {
    double* block = matrix_.block(matrix_.pattern().find(std::max(row, column), std::min(row, column)));
    for (int c = 0; c < dimension_; ++c) {
      for (int r = 0; r < dimension_; ++r) {
        (row > column ? block[c * dimension_ + r] : block[r * dimension_ + c]) += values(r, c);
      }
    }
  }
  /// Entry `row` of a block in right-hand side k.
  double& right(int block, int row, int k) {
    return right_[static_cast<std::size_t>(k) * static_cast<std::size_t>(matrix_.layout().scalars()) +
                  static_cast<std::size_t>(block * dimension_ + row)];
  }
  /// Overwrites the right-hand sides with the solutions.
  void solve(int count, const StopCondition& stop) {
    SolverStatus status = solver_->factorize(matrix_, {}, stop);
    if (status.outcome == SolverStatus::Outcome::interrupted) throw WorkStopped();
    if (status.ok()) status = solver_->solve(right_, count);
    if (!status.ok()) throw GraphError("chordal initialisation: the relative poses leave some pose undetermined");
  }

 private:
  int dimension_;
  std::unique_ptr<LinearSolver> solver_;
  BlockMatrix matrix_;
  std::vector<int> position_;
  std::vector<double> right_;
};

/// The nearest rotation, in the Frobenius norm.
template <int D>
Matrix<double, D, D> nearestRotation(const Matrix<double, D, D>& M) {
  const Eigen::JacobiSVD<Matrix<double, D, D>> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix<double, D, D> U = svd.matrixU();
  const Matrix<double, D, D> Vt = svd.matrixV().transpose();
  if ((U * Vt).determinant() < 0.0) U.col(D - 1) = -U.col(D - 1);
  return U * Vt;
}

/// Rows of the rotations: with ρ_i a row of R_i as a column, Σ κ ‖ρ_j − R_ijᵀ ρ_i‖², D right-hand sides.
template <int D>
void solveRotations(PoseGraph<D>& poses, int threads, std::vector<int>& order, const StopCondition& stop) {
  PoseSystem system(poses, D, threads, order);
  for (const auto& edge : poses.edges) {
    const int i = system.position(edge.from);
    const int j = system.position(edge.to);
    const double weight = edge.rotationWeight;
    if (i >= 0) system.addDiagonal(i, weight);
    if (j >= 0) system.addDiagonal(j, weight);
    if (i >= 0 && j >= 0) system.addOffDiagonal(i, j, Matrix<double, D, D>(-weight * edge.rotation));
    if ((i < 0) == (j < 0)) continue;
    const Matrix<double, D, D> known =
        i < 0 ? Matrix<double, D, D>(poses.rotations[static_cast<std::size_t>(edge.from)] * edge.rotation)
              : Matrix<double, D, D>(poses.rotations[static_cast<std::size_t>(edge.to)] * edge.rotation.transpose());
    for (int k = 0; k < D; ++k) {
      for (int r = 0; r < D; ++r) system.right(i < 0 ? j : i, r, k) += weight * known(k, r);
    }
  }
  system.solve(D, stop);
  const auto project = [&](std::size_t pose) {
    const int block = system.position(static_cast<int>(pose));
    if (block < 0) return;
    Matrix<double, D, D> M;
    for (int k = 0; k < D; ++k) {
      for (int r = 0; r < D; ++r) M(k, r) = system.right(block, r, k);
    }
    poses.rotations[pose] = nearestRotation<D>(M);
  };
  constexpr std::size_t piece = 256;
  const std::size_t count = poses.rotations.size();
  parallelFor(static_cast<std::int64_t>((count + piece - 1) / piece), threads, [&](std::int64_t p) {
    const std::size_t begin = static_cast<std::size_t>(p) * piece;
    for (std::size_t pose = begin; pose < std::min(count, begin + piece); ++pose) project(pose);
  });
}

/// Σ τ ‖t_j − t_i − R_i t_ij‖²: a scalar Laplacian, D right-hand sides.
template <int D>
void solveTranslations(PoseGraph<D>& poses, int threads, std::vector<int>& order, const StopCondition& stop) {
  PoseSystem system(poses, 1, threads, order);
  const auto minus = [](double weight) { return [weight](int, int) { return -weight; }; };
  for (const auto& edge : poses.edges) {
    const int i = system.position(edge.from);
    const int j = system.position(edge.to);
    const double weight = edge.translationWeight;
    const Vector<double, D> step = poses.rotations[static_cast<std::size_t>(edge.from)] * edge.translation;
    if (i >= 0) system.addDiagonal(i, weight);
    if (j >= 0) system.addDiagonal(j, weight);
    if (i >= 0 && j >= 0) system.addOffDiagonal(i, j, minus(weight));
    for (int k = 0; k < D; ++k) {
      if (i >= 0)
        system.right(i, 0, k) +=
            weight * ((j < 0 ? poses.translations[static_cast<std::size_t>(edge.to)][k] : 0.0) - step[k]);
      if (j >= 0)
        system.right(j, 0, k) +=
            weight * ((i < 0 ? poses.translations[static_cast<std::size_t>(edge.from)][k] : 0.0) + step[k]);
    }
  }
  system.solve(D, stop);
  for (std::size_t pose = 0; pose < poses.translations.size(); ++pose) {
    const int block = system.position(static_cast<int>(pose));
    for (int k = 0; block >= 0 && k < D; ++k) poses.translations[pose][k] = system.right(block, 0, k);
  }
}

/// Estimates all poses of one kind; the number of them.
template <int D>
std::int64_t estimatePoses(Graph& graph, const Options& options) {
  const StopCondition stop(options.timeLimit, options.stopToken);
  PoseGraph<D> poses = readPoseGraph<D>(graph, options);
  const std::int64_t count = static_cast<std::int64_t>(poses.vertices.size());
  if (poses.components > 1) {
    // A pose that no relative pose reaches stands alone in its component: without an estimate of its own there is
    // nothing to say of it.
    std::vector<int> sizes(static_cast<std::size_t>(poses.components), 0);
    for (const int component : poses.component) ++sizes[static_cast<std::size_t>(component)];
    for (std::size_t i = 0; i < poses.vertices.size(); ++i) {
      if (sizes[static_cast<std::size_t>(poses.component[i])] == 1 && !poses.vertices[i]->hasEstimate()) {
        throw GraphError(
            fmt::format("chordal initialisation: no relative pose reaches vertex {}", poses.vertices[i]->id()));
      }
    }
  }
  if (std::find(poses.held.begin(), poses.held.end(), 0) != poses.held.end()) {
    const int threads = options.threads > 0 ? options.threads : hardwareThreads();
    std::vector<int> order;
    stop.throwIfReached();  // before the ordering
    solveRotations(poses, threads, order, stop);
    solveTranslations(poses, threads, order, stop);
  }
  writePoses(poses, graph);
  return count;
}

}  // namespace

std::string chordalEstimate(Graph& graph, const Options& options) {
  EstimatesGuard guard(graph);
  const std::int64_t count = estimatePoses<2>(graph, options) + estimatePoses<3>(graph, options);
  if (count == 0) throw GraphError("chordal initialisation: the graph has no poses");
  const std::int64_t others = propagateFromPoses(graph, options);
  guard.keep();
  const std::string poses = fmt::format("chordal relaxation of {} pose{}", count, count == 1 ? "" : "s");
  if (others == 0) return poses;
  return fmt::format("{}, {} other vert{} from there", poses, others, others == 1 ? "ex" : "ices");
}

}  // namespace quiver
