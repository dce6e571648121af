#include <quiver/plugins/builtin.h>

#include <quiver/core/algorithm/algorithms.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/initialization/automatic.h>
#include <quiver/initialization/chordal.h>
#include <quiver/initialization/spanning_tree.h>
#include <quiver/solvers/automatic_system.h>
#include <quiver/solvers/backends/block_solver.h>
#include <quiver/solvers/backends/dense_solver.h>
#include <quiver/solvers/backends/eigen_solver.h>
#include <quiver/solvers/backends/pcg_solver.h>
#include <quiver/solvers/backends/power_solver.h>
#include <quiver/types_sba/register.h>
#include <quiver/types_slam2d/register.h>
#include <quiver/types_slam3d/measured_points.h>
#include <quiver/types_slam3d/register.h>

namespace quiver {
namespace {

void addLinearSolver(Registry& registry, const char* name, const char* documentation,
                     std::unique_ptr<LinearSolver> (*make)()) {
  registry.addLinearSystem(name, documentation,
                           [make](const Options&) { return std::make_unique<AutomaticSystem>(make); });
}

}  // namespace

void registerLinearSystems(Registry& registry) {
  registry.addLinearSystem("auto", "The linear solver of least predicted cost, chosen when the structure is known.",
                           [](const Options&) { return std::make_unique<AutomaticSystem>(); });
  addLinearSolver(registry, "block", "Sparse block Cholesky of quiver's own; the same bits for any number of threads.",
                  makeBlockSolver);
  addLinearSolver(registry, "dense", "Dense Cholesky of the whole matrix, for systems that are small or full.",
                  makeDenseSolver);
  addLinearSolver(registry, "eigen", "Eigen's simplicial LDLT on scalars: an independent reference, one thread.",
                  makeEigenSolver);
  registry.addLinearSystem("pcg",
                           "Conjugate gradients with block-Jacobi preconditioning: little memory; as exact as needed.",
                           [](const Options& options) {
                             return std::make_unique<AutomaticSystem>([options] {
                               return makePcgSolver({options.linearTolerance, options.maxLinearIterations, true});
                             });
                           });
  registry.addLinearSystem(
      "power", "Power series of the reduced system after elimination: low accuracy, little memory.",
      [](const Options& options) {
        return std::make_unique<AutomaticSystem>([options] {
          return makePowerSolver(options.linearTolerance,
                                 options.maxLinearIterations > 0 ? options.maxLinearIterations : 10000);
        });
      });
}

void registerInitializers(Registry& registry) {
  registry.addInitializer("auto",
                          "The file's estimates where every vertex has one, else a tree; chordal or points where "
                          "their chi2 is lower.",
                          automaticEstimate);
  registry.addInitializer("tree", "Dead reckoning along the paths that accumulate the least variance.",
                          spanningTreeEstimate);
  registry.addInitializer("odometry", "Dead reckoning along edges between consecutive ids.", odometryEstimate);
  registry.addInitializer("chordal",
                          "Rotations as free matrices by a linear problem, then translations by another; poses only.",
                          chordalEstimate);
  registry.addInitializer("points",
                          "Optimises pixels with depths or disparities as the points they measure, from the estimates "
                          "at hand.",
                          measuredPointsEstimate);
}

std::shared_ptr<Registry> builtinRegistry() {
  auto registry = std::make_shared<Registry>();
  registerSlam2d(*registry);
  registerSlam3d(*registry);
  registerSba(*registry);
  registerRobustKernels(*registry);
  registerLinearSystems(*registry);
  registerAlgorithms(*registry);
  registerInitializers(*registry);
  return registry;
}

}  // namespace quiver
