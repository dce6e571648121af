#pragma once

#include <string>

#include <quiver/core/registry/registry.h>
#include <quiver/plugins/plugin.h>

namespace quiver {

/// Loads a plugin and lets it register what it brings. The registry keeps the library loaded for as long as it lives.
/// Returns a sentence that says what was added.
///
/// Throws PluginError if the file is missing, is no plugin, was built for another ABI than this program (both are
/// printed), or fails to register; in the last case what it had registered before stays. Not thread safe.
std::string loadPlugin(Registry& registry, const std::string& path);

/// Why a plugin of ABI `plugin` cannot serve a program of ABI `host`, one line a difference with both values; empty if
/// it can. `available` holds the bits of the processor's instruction sets.
std::string abiMismatch(const PluginAbi& plugin, const PluginAbi& host, std::uint32_t available);

/// The instruction sets of this processor, as PluginAbi::InstructionSet bits.
std::uint32_t processorInstructionSets();

}  // namespace quiver
