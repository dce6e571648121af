#pragma once

namespace CLI {
class App;
}

namespace quiver::app {

/// Adds `quiver simulate bundle` to the simulate command.
void addBundleSimulation(CLI::App& simulate);

}  // namespace quiver::app
