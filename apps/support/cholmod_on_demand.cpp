#include <quiver/apps/support/cholmod_on_demand.h>

#ifdef QUIVER_CHOLMOD_LIBRARY

#  include <dlfcn.h>

#  include <filesystem>

#  include <quiver/core/algorithm/linear_system.h>
#  include <quiver/core/util/error.h>
#  include <quiver/plugins/plugin_loader.h>

namespace quiver::app {
namespace {

/// The folder of the quiver library this program runs with.
std::filesystem::path libraryFolder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&loadPlugin), &info) == 0 || info.dli_fname == nullptr)
    throw PluginError("cholmod: the folder of the quiver library is not known");
  return std::filesystem::path(info.dli_fname).parent_path();
}

}  // namespace

void addCholmodOnDemand(Registry& registry) {
  const auto loaded = std::make_shared<Registry>();
  registry.addLinearSystem("cholmod", "SuiteSparse's CHOLMOD on scalars, supernodal or simplicial as it decides (GPL).",
                           [loaded](const Options& options) {
                             const LinearSystemFactory* factory = loaded->findLinearSystem("cholmod");
                             if (factory == nullptr) {
                               loadPlugin(*loaded, (libraryFolder() / QUIVER_CHOLMOD_LIBRARY).string());
                               factory = loaded->findLinearSystem("cholmod");
                             }
                             return (*factory)(options);
                           });
}

}  // namespace quiver::app

#else

namespace quiver::app {

void addCholmodOnDemand(Registry&) {}

}  // namespace quiver::app

#endif
