// A plugin that was built for another quiver: it must be refused before its code runs.
#include <cstdlib>

#include <quiver/plugins/plugin.h>

namespace {

constexpr quiver::PluginAbi strangeAbi() {
  quiver::PluginAbi abi = quiver::compiledAbi();
  abi.versionMajor = 9;
  abi.versionMinor = 9;
  return abi;
}

}  // namespace

extern "C" {
__attribute__((visibility("default"))) extern const quiver::PluginAbi quiverPluginAbi;
const quiver::PluginAbi quiverPluginAbi = strangeAbi();
__attribute__((visibility("default"))) int quiverPlugin(quiver::PluginHost*) { std::abort(); }
}
