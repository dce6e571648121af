#include <quiver/plugins/plugin_loader.h>

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver {
namespace {

constexpr std::array<std::pair<std::uint32_t, std::string_view>, 8> instructionSetNames{
    {{PluginAbi::sse42, "SSE4.2"},
     {PluginAbi::avx, "AVX"},
     {PluginAbi::avx2, "AVX2"},
     {PluginAbi::fma, "FMA"},
     {PluginAbi::avx512f, "AVX-512F"},
     {PluginAbi::avx512dq, "AVX-512DQ"},
     {PluginAbi::avx512vl, "AVX-512VL"},
     {PluginAbi::avx512bw, "AVX-512BW"}}};

std::string describeInstructionSets(std::uint32_t sets) {
  std::string text;
  for (const auto& [bit, name] : instructionSetNames) {
    if (sets & bit) text += fmt::format("{}{}", text.empty() ? "" : " ", name);
  }
  return text.empty() ? "none" : text;
}

std::string describeLibrary(const PluginAbi& abi) {
  if (abi.standardLibrary == PluginAbi::libcxx) return fmt::format("libc++ of ABI {}", abi.standardLibraryMode);
  if (abi.standardLibrary != PluginAbi::libstdcxx) return "another library";
  return fmt::format("libstdc++ with the {} strings{}", abi.standardLibraryMode & 1 ? "C++11" : "old",
                     abi.standardLibraryMode & 2 ? ", debug mode" : "");
}

using Library = std::shared_ptr<void>;

Library open(const std::string& path, int mode) {
  void* handle = dlopen(path.c_str(), mode | RTLD_LOCAL);
  if (!handle) {
    const char* reason = dlerror();
    throw PluginError(fmt::format("{}: cannot be loaded: {}", path, reason ? reason : "no reason given"));
  }
  return {handle, [](void* library) { dlclose(library); }};
}

void* symbol(const Library& library, const std::string& path, const char* name) {
  void* address = dlsym(library.get(), name);
  if (!address)
    throw PluginError(fmt::format("{}: is no quiver plugin: it has no symbol {} (QUIVER_PLUGIN makes it)", path, name));
  return address;
}

void checkAbi(const Library& library, const std::string& path) {
  const PluginAbi host = compiledAbi();
  const auto& abi = *static_cast<const PluginAbi*>(symbol(library, path, "quiverPluginAbi"));
  if (abi.magic != host.magic || abi.bytes < sizeof(PluginAbi))
    throw PluginError(fmt::format("{}: is no quiver plugin: its quiverPluginAbi is something else", path));
  const std::string mismatch = abiMismatch(abi, host, processorInstructionSets());
  if (!mismatch.empty()) throw PluginError(fmt::format("{}: built for another ABI: {}", path, mismatch));
}

struct Counts {
  explicit Counts(const Registry& registry)
      : of{registry.vertexTypes().size(),   registry.edgeTypes().size(),     registry.parameterTypes().size(),
           registry.dataTags().size(),      registry.linearSystems().size(), registry.initializers().size(),
           registry.robustKernels().size(), registry.algorithms().size()} {}
  std::array<std::size_t, 8> of;
};

std::string describeAdded(const Counts& before, const Counts& after) {
  static constexpr std::array<std::string_view, 8> names{"vertex type",   "edge type",   "parameter type", "data tag",
                                                         "linear solver", "initialiser", "robust kernel",  "algorithm"};
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t added = after.of[i] - before.of[i];
    if (added > 0) text += fmt::format("{}{} {}{}", text.empty() ? "" : ", ", added, names[i], added == 1 ? "" : "s");
  }
  return text.empty() ? "nothing" : text;
}

}  // namespace

std::uint32_t processorInstructionSets() {
  std::uint32_t sets = 0;
#if defined(__x86_64__) || defined(__i386__)
  if (__builtin_cpu_supports("sse4.2")) sets |= PluginAbi::sse42;
  if (__builtin_cpu_supports("avx")) sets |= PluginAbi::avx;
  if (__builtin_cpu_supports("avx2")) sets |= PluginAbi::avx2;
  if (__builtin_cpu_supports("fma")) sets |= PluginAbi::fma;
  if (__builtin_cpu_supports("avx512f")) sets |= PluginAbi::avx512f;
  if (__builtin_cpu_supports("avx512dq")) sets |= PluginAbi::avx512dq;
  if (__builtin_cpu_supports("avx512vl")) sets |= PluginAbi::avx512vl;
  if (__builtin_cpu_supports("avx512bw")) sets |= PluginAbi::avx512bw;
#endif
  return sets;
}

std::string abiMismatch(const PluginAbi& plugin, const PluginAbi& host, std::uint32_t available) {
  std::string text;
  const auto differ = [&text](std::string_view what, const std::string& ofPlugin, const std::string& ofHost) {
    if (ofPlugin == ofHost) return;
    text += fmt::format("{}{}: the plugin has {}, this program {}", text.empty() ? "" : "; ", what, ofPlugin, ofHost);
  };
  differ("quiver", fmt::format("{}.{}", plugin.versionMajor, plugin.versionMinor),
         fmt::format("{}.{}", host.versionMajor, host.versionMinor));
  differ("C++ library", describeLibrary(plugin), describeLibrary(host));
  differ("C++ standard", fmt::format("{}", plugin.cppStandard), fmt::format("{}", host.cppStandard));
  differ("Eigen", fmt::format("{}.{}", plugin.eigenMajor, plugin.eigenMinor),
         fmt::format("{}.{}", host.eigenMajor, host.eigenMinor));
  if ((plugin.instructionSets & ~available) != 0) {
    text += fmt::format("{}instruction sets: the plugin needs {}, this processor has {}", text.empty() ? "" : "; ",
                        describeInstructionSets(plugin.instructionSets), describeInstructionSets(available));
  }
  return text;
}

std::string loadPlugin(Registry& registry, const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw PluginError(fmt::format("{}: no such file", path));
  const std::string absolute = std::filesystem::absolute(path, error).string();
  // Lazily first, so that a plugin for another quiver is refused for its ABI, not for a symbol it misses.
  Library library = open(absolute, RTLD_LAZY);
  checkAbi(library, path);
  library.reset();  // what is open lazily stays so
  // An exception of the plugin's may outlive the registry, so its code stays.
  library = open(absolute, RTLD_NOW | RTLD_NODELETE);
  using Entry = int (*)(PluginHost*);
  const auto entry = reinterpret_cast<Entry>(symbol(library, path, "quiverPlugin"));
  registry.keepAlive(library);
  const Counts before(registry);
  std::string failure;
  PluginHost host{&registry, [](PluginHost* self, const char* message) { *self->failure = message; }, &failure};
  if (entry(&host) != 0)
    throw PluginError(
        fmt::format("{}: cannot register: {}", path, failure.empty() ? "an exception without a text" : failure));
  return fmt::format("{}: {}", path, describeAdded(before, Counts(registry)));
}

}  // namespace quiver
