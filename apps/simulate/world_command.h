#pragma once

namespace CLI {
class App;
}

namespace quiver::app {

/// Adds `quiver simulate manhattan`, `grid`, `landmarks-2d` and `landmarks-3d` to the simulate command.
void addWorldSimulations(CLI::App& simulate);

}  // namespace quiver::app
