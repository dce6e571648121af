#include "ceres_pose_graph.h"

#include <cmath>

#include <ceres/ceres.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "measure.h"
#include "stream_reader.h"

namespace quiver::bench {
namespace {

/// U with UᵀU = Ω.
template <int N>
Eigen::Matrix<double, N, N> squareRoot(const std::vector<double>& triangle) {
  Eigen::Matrix<double, N, N> information;
  std::size_t k = 0;
  for (int r = 0; r < N; ++r) {
    for (int c = r; c < N; ++c) information(r, c) = information(c, r) = triangle[k++];
  }
  return information.llt().matrixU();
}

struct PlanarError {
  std::array<double, 3> z;
  Eigen::Matrix3d root;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    using std::cos;
    using std::floor;
    using std::sin;
    const T angle = a[2] + z[2];
    const T dx = b[0] - a[0];
    const T dy = b[1] - a[1];
    const double zx = std::cos(z[2]) * z[0] + std::sin(z[2]) * z[1];
    const double zy = -std::sin(z[2]) * z[0] + std::cos(z[2]) * z[1];
    const T turn = b[2] - angle;
    Eigen::Matrix<T, 3, 1> error;
    error[0] = cos(angle) * dx + sin(angle) * dy - zx;
    error[1] = -sin(angle) * dx + cos(angle) * dy - zy;
    error[2] = turn - 2.0 * M_PI * floor((turn + M_PI) / (2.0 * M_PI));
    Eigen::Map<Eigen::Matrix<T, 3, 1>>(residual, 3) = root * error;
    return true;
  }
};

struct SpatialError {
  Eigen::Vector3d t;
  Eigen::Quaterniond q;
  Eigen::Matrix<double, 6, 6> root;

  template <typename T>
  bool operator()(const T* ta, const T* qa, const T* tb, const T* qb, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Vector> pa(ta);
    const Eigen::Map<const Vector> pb(tb);
    const Eigen::Map<const Eigen::Quaternion<T>> ra(qa);
    const Eigen::Map<const Eigen::Quaternion<T>> rb(qb);
    const Eigen::Quaternion<T> relative = ra.conjugate() * rb;
    const Eigen::Quaternion<T> off = q.conjugate().template cast<T>() * relative;
    Eigen::Matrix<T, 6, 1> error;
    error.template head<3>() = q.conjugate().template cast<T>() * (ra.conjugate() * (pb - pa) - t.template cast<T>());
    error.template tail<3>() = off.w() < T(0.0) ? Vector(-off.vec()) : Vector(off.vec());
    Eigen::Map<Eigen::Matrix<T, 6, 1>>(residual, 6) = root.template cast<T>() * error;
    return true;
  }
};

void addPlanar(ceres::Problem& problem, StreamGraph& graph) {
  for (const auto& edge : graph.edges) {
    const auto& m = edge->measurement;
    auto* cost = new ceres::AutoDiffCostFunction<PlanarError, 3, 3, 3>(
        new PlanarError{{m[0], m[1], m[2]}, squareRoot<3>(edge->information)});
    problem.AddResidualBlock(cost, nullptr, graph.vertices.at(edge->from)->values.data(),
                             graph.vertices.at(edge->to)->values.data());
  }
  problem.SetParameterBlockConstant(graph.vertices.begin()->second->values.data());
}

void addSpatial(ceres::Problem& problem, StreamGraph& graph) {
  auto* manifold = new ceres::EigenQuaternionManifold;
  for (auto& [id, vertex] : graph.vertices) {
    double* x = vertex->values.data();
    Eigen::Map<Eigen::Quaterniond>(x + 3).normalize();
    problem.AddParameterBlock(x, 3);
    problem.AddParameterBlock(x + 3, 4, manifold);
  }
  for (const auto& edge : graph.edges) {
    const auto& m = edge->measurement;
    auto* cost = new ceres::AutoDiffCostFunction<SpatialError, 6, 3, 4, 3, 4>(new SpatialError{
        {m[0], m[1], m[2]}, Eigen::Quaterniond(m[6], m[3], m[4], m[5]).normalized(), squareRoot<6>(edge->information)});
    double* a = graph.vertices.at(edge->from)->values.data();
    double* b = graph.vertices.at(edge->to)->values.data();
    problem.AddResidualBlock(cost, nullptr, a, a + 3, b, b + 3);
  }
  double* first = graph.vertices.begin()->second->values.data();
  problem.SetParameterBlockConstant(first);
  problem.SetParameterBlockConstant(first + 3);
}

}  // namespace

CeresResult solveWithCeres(const std::string& file, int iterations, int threads, bool toOptimum) {
  CeresResult result;
  StreamGraph graph;
  ceres::Problem problem;
  result.loadSeconds = secondsOf([&] {
    graph = readWithStreams(file);
    if (graph.dimension == 3) {
      addSpatial(problem, graph);
    } else {
      addPlanar(problem, graph);
    }
  });
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = threads;
  options.max_num_iterations = iterations;
  options.function_tolerance = toOptimum ? 1e-10 : 0.0;
  options.gradient_tolerance = 0.0;
  options.parameter_tolerance = 0.0;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  result.solveSeconds = secondsOf([&] { ceres::Solve(options, &problem, &summary); });
  result.chi2 = 2.0 * summary.final_cost;
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  std::vector<double> seconds;
  for (const auto& iteration : summary.iterations) {
    if (iteration.iteration > 0) seconds.push_back(iteration.iteration_time_in_seconds);
  }
  result.iterationSeconds = median(seconds);
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  return result;
}

}  // namespace quiver::bench
