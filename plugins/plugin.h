#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <Eigen/Core>

#include <quiver/core/registry/registry.h>
#include <quiver/version.h>

namespace quiver {

/// What a plugin was compiled for and a program must share with it. Plain data whose layout never changes (later
/// versions append, and `bytes` tells which they are), so it can be read before any code of the plugin runs. The
/// compiler's version and `-march` are not part of it: nothing that crosses the boundary depends on them.
struct PluginAbi {
  /// Instruction sets that code was allowed to use, as bits.
  enum InstructionSet : std::uint32_t {
    avx = 1,
    avx2 = 2,
    fma = 4,
    avx512f = 8,
    avx512dq = 16,
    avx512vl = 32,
    avx512bw = 64,
    sse42 = 128
  };
  enum StandardLibrary : std::int32_t { otherLibrary = 0, libstdcxx = 1, libcxx = 2 };

  std::array<char, 8> magic;
  std::uint32_t bytes;
  std::int32_t versionMajor;
  std::int32_t versionMinor;
  std::int32_t standardLibrary;
  /// libstdc++: bit 0 the C++11 string, bit 1 debug mode; libc++: its ABI version.
  std::int32_t standardLibraryMode;
  /// __cplusplus: 202002 for C++20.
  std::int64_t cppStandard;
  std::int32_t eigenMajor;
  std::int32_t eigenMinor;
  std::uint32_t instructionSets;
  std::uint32_t reserved;
};

namespace detail {

constexpr std::uint32_t compiledInstructionSets() {
  std::uint32_t sets = 0;
#ifdef __SSE4_2__
  sets |= PluginAbi::sse42;
#endif
#ifdef __AVX__
  sets |= PluginAbi::avx;
#endif
#ifdef __AVX2__
  sets |= PluginAbi::avx2;
#endif
#ifdef __FMA__
  sets |= PluginAbi::fma;
#endif
#ifdef __AVX512F__
  sets |= PluginAbi::avx512f;
#endif
#ifdef __AVX512DQ__
  sets |= PluginAbi::avx512dq;
#endif
#ifdef __AVX512VL__
  sets |= PluginAbi::avx512vl;
#endif
#ifdef __AVX512BW__
  sets |= PluginAbi::avx512bw;
#endif
  return sets;
}

constexpr std::int32_t compiledStandardLibrary() {
#if defined(__GLIBCXX__)
  return PluginAbi::libstdcxx;
#elif defined(_LIBCPP_VERSION)
  return PluginAbi::libcxx;
#else
  return PluginAbi::otherLibrary;
#endif
}

constexpr std::int32_t compiledStandardLibraryMode() {
  std::int32_t mode = 0;
#if defined(_GLIBCXX_USE_CXX11_ABI) && _GLIBCXX_USE_CXX11_ABI
  mode |= 1;
#endif
#ifdef _GLIBCXX_DEBUG
  mode |= 2;
#endif
#ifdef _LIBCPP_ABI_VERSION
  mode = _LIBCPP_ABI_VERSION;
#endif
  return mode;
}

}  // namespace detail

/// What the translation unit that calls it is compiled for.
constexpr PluginAbi compiledAbi() {
  return {{'q', 'u', 'i', 'v', 'e', 'r', '\0', '\0'},
          sizeof(PluginAbi),
          QUIVER_VERSION_MAJOR,
          QUIVER_VERSION_MINOR,
          detail::compiledStandardLibrary(),
          detail::compiledStandardLibraryMode(),
          static_cast<std::int64_t>(__cplusplus),
          EIGEN_WORLD_VERSION,
          EIGEN_MAJOR_VERSION,
          detail::compiledInstructionSets(),
          0};
}

/// What a program hands to a plugin's entry point.
struct PluginHost {
  Registry* registry;
  /// Tells the program why the plugin did not register; copies the message.
  void (*fail)(PluginHost* host, const char* message);
  std::string* failure;
};

namespace detail {

/// Calls a plugin's function and keeps its exceptions from crossing the C boundary. Returns 0 on success.
template <typename Function>
int runPlugin(PluginHost* host, Function function) noexcept {
  try {
    function(*host->registry);
    return 0;
  } catch (const std::exception& error) {
    host->fail(host, error.what());
  } catch (...) {
    host->fail(host, "it threw something that is no std::exception");
  }
  return 1;
}

}  // namespace detail
}  // namespace quiver

/// Makes a shared library a plugin, once in one of its source files, at namespace scope: `function` is a
/// `void(quiver::Registry&)` that adds what the plugin brings.
#define QUIVER_PLUGIN(function)                                                                  \
  extern "C" __attribute__((visibility("default"))) const quiver::PluginAbi quiverPluginAbi;     \
  const quiver::PluginAbi quiverPluginAbi = quiver::compiledAbi();                               \
  extern "C" __attribute__((visibility("default"))) int quiverPlugin(quiver::PluginHost* host) { \
    return quiver::detail::runPlugin(host, function);                                            \
  }                                                                                              \
  static_assert(true, "a semicolon follows")
