#pragma once

namespace CLI {
class App;
}

namespace quiver::app {

/// Adds `quiver simulate outliers` to the simulate command.
void addOutliersSimulation(CLI::App& simulate);

}  // namespace quiver::app
