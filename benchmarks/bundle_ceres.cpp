#include "bundle_ceres.h"

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <vector>

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "peers/measure.h"

namespace quiver::bench {
namespace {

/// Seen less measured in a camera of nine numbers: rotation vector, translation, f, k1, k2.
struct PixelError {
  double u, v;

  template <typename T>
  bool operator()(const T* camera, const T* point, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(camera, point, p);
    for (int i = 0; i < 3; ++i) p[i] += camera[3 + i];
    const T x = -p[0] / p[2];
    const T y = -p[1] / p[2];
    const T square = x * x + y * y;
    const T scale = camera[6] * (T(1.0) + square * (camera[7] + camera[8] * square));
    residual[0] = scale * x - u;
    residual[1] = scale * y - v;
    return true;
  }
};

struct BundleFile {
  int cameras = 0;
  int points = 0;
  std::vector<int> cameraOf, pointOf;
  std::vector<double> pixels, values;
};

BundleFile readBundle(const std::string& name) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(name.c_str(), "r"), std::fclose);
  BundleFile bundle;
  int observations = 0;
  bool good = file && std::fscanf(file.get(), "%d %d %d", &bundle.cameras, &bundle.points, &observations) == 3;
  for (int i = 0; good && i < observations; ++i) {
    int camera = 0, point = 0;
    double u = 0.0, v = 0.0;
    good = std::fscanf(file.get(), "%d %d %lf %lf", &camera, &point, &u, &v) == 4;
    bundle.cameraOf.push_back(camera);
    bundle.pointOf.push_back(point);
    bundle.pixels.insert(bundle.pixels.end(), {u, v});
  }
  bundle.values.resize(static_cast<std::size_t>(9 * bundle.cameras + 3 * bundle.points));
  for (double& value : bundle.values) good = good && std::fscanf(file.get(), "%lf", &value) == 1;
  if (!good) throw std::runtime_error(name + " is no bundle adjustment file");
  return bundle;
}

}  // namespace

CeresBundleResult solveBundleWithCeres(const std::string& file, int iterations, int threads, bool sparse) {
  CeresBundleResult result;
  BundleFile bundle;
  ceres::Problem problem;
  auto* ordering = new ceres::ParameterBlockOrdering;
  result.loadSeconds = secondsOf([&] {
    bundle = readBundle(file);
    double* const cameras = bundle.values.data();
    double* const points = cameras + 9 * bundle.cameras;
    for (std::size_t i = 0; i < bundle.cameraOf.size(); ++i) {
      auto* cost = new ceres::AutoDiffCostFunction<PixelError, 2, 9, 3>(
          new PixelError{bundle.pixels[2 * i], bundle.pixels[2 * i + 1]});
      problem.AddResidualBlock(cost, nullptr, cameras + 9 * bundle.cameraOf[i], points + 3 * bundle.pointOf[i]);
    }
    for (int i = 0; i < bundle.points; ++i) ordering->AddElementToGroup(points + 3 * i, 0);
    for (int i = 0; i < bundle.cameras; ++i) ordering->AddElementToGroup(cameras + 9 * i, 1);
  });
  ceres::Solver::Options options;
  options.linear_solver_type = sparse ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
  options.linear_solver_ordering.reset(ordering);
  options.num_threads = threads;
  options.max_num_iterations = iterations;
  options.function_tolerance = 0.0;
  options.gradient_tolerance = 0.0;
  options.parameter_tolerance = 0.0;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  result.solveSeconds = secondsOf([&] { ceres::Solve(options, &problem, &summary); });
  result.cost = summary.final_cost;
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  for (const auto& iteration : summary.iterations) {
    if (iteration.iteration > 0) result.iterationSeconds += iteration.iteration_time_in_seconds;
  }
  return result;
}

}  // namespace quiver::bench
