// quiver::cholmod as a plugin: programs that load it when it is asked for neither link GPL code nor wait for its
// libraries at every start.
#include <quiver/plugins/plugin.h>
#include <quiver/solvers/automatic_system.h>
#include <quiver/solvers/backends/cholmod/cholmod_solver.h>

namespace {

void registerCholmod(quiver::Registry& registry) {
  registry.addLinearSystem(
      "cholmod", "SuiteSparse's CHOLMOD on scalars, supernodal or simplicial as it decides (GPL).",
      [](const quiver::Options&) { return std::make_unique<quiver::AutomaticSystem>(quiver::makeCholmodSolver); });
}

}  // namespace

QUIVER_PLUGIN(registerCholmod);
