#include <quiver/plugins/plugin_loader.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>

namespace quiver {
namespace {

using testing::HasSubstr;

TEST(PluginAbi, MatchesItself) { EXPECT_EQ(abiMismatch(compiledAbi(), compiledAbi(), processorInstructionSets()), ""); }

TEST(PluginAbi, PrintsBothSidesOfEveryDifference) {
  const PluginAbi host = compiledAbi();
  PluginAbi plugin = host;
  plugin.versionMinor = host.versionMinor + 1;
  plugin.standardLibraryMode ^= 1;
  plugin.cppStandard = 201703;
  plugin.eigenMinor = host.eigenMinor + 5;
  const std::string text = abiMismatch(plugin, host, processorInstructionSets());
  EXPECT_THAT(text, HasSubstr("quiver: the plugin has 0.2, this program 0.1"));
  EXPECT_THAT(text, HasSubstr("C++ library: the plugin has libstdc++ with the old strings, this program libstdc++ with "
                              "the C++11 strings"));
  EXPECT_THAT(text, HasSubstr("C++ standard: the plugin has 201703, this program 202002"));
  EXPECT_THAT(text, HasSubstr("Eigen: the plugin has 3.9, this program 3.4"));
}

TEST(PluginAbi, NeedsTheInstructionSetsOfThePluginOnly) {
  PluginAbi plugin = compiledAbi();
  plugin.instructionSets = PluginAbi::avx | PluginAbi::avx2;
  EXPECT_EQ(abiMismatch(plugin, compiledAbi(), PluginAbi::avx | PluginAbi::avx2 | PluginAbi::fma), "");
  EXPECT_EQ(abiMismatch(plugin, compiledAbi(), PluginAbi::avx),
            "instruction sets: the plugin needs AVX AVX2, this processor has AVX");
}

TEST(PluginLoader, RefusesWhatIsNoLibrary) {
  Registry registry;
  EXPECT_THROW(loadPlugin(registry, "no/such/plugin.so"), PluginError);
  EXPECT_THROW(loadPlugin(registry, "."), PluginError);
}

TEST(PluginInterface, KeepsExceptionsOnItsSide) {
  Registry registry;
  std::string failure;
  PluginHost host{&registry, [](PluginHost* self, const char* message) { *self->failure = message; }, &failure};
  EXPECT_EQ(detail::runPlugin(&host, [](Registry&) {}), 0);
  EXPECT_EQ(detail::runPlugin(&host, [](Registry&) { throw GraphError("tag taken"); }), 1);
  EXPECT_EQ(failure, "tag taken");
  EXPECT_EQ(detail::runPlugin(&host, [](Registry&) { throw 7; }), 1);
  EXPECT_THAT(failure, HasSubstr("no std::exception"));
}

TEST(BuiltinRegistry, HasTypesSolversStartsAndKernels) {
  const auto registry = builtinRegistry();
  for (const char* tag : {"VERTEX_SE2", "VERTEX_XY", "VERTEX_SE3:QUAT", "VERTEX_TRACKXYZ"})
    EXPECT_NE(registry->findVertexType(tag), nullptr) << tag;
  for (const char* tag : {"EDGE_SE2", "EDGE_SE2_XY", "EDGE_PRIOR_SE2", "EDGE_SE3:QUAT", "EDGE_SE3:LOG"})
    EXPECT_NE(registry->findEdgeType(tag), nullptr) << tag;
  for (const char* name : {"auto", "block", "dense", "eigen"})
    EXPECT_NE(registry->findLinearSystem(name), nullptr) << name;
  for (const char* name : {"auto", "tree", "odometry"}) EXPECT_NE(registry->findInitializer(name), nullptr) << name;
  for (const char* name : {"huber", "cauchy", "tukey"}) EXPECT_NE(registry->findRobustKernel(name), nullptr) << name;
  EXPECT_NE(registry, builtinRegistry());
}

}  // namespace
}  // namespace quiver
