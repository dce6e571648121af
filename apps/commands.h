#pragma once

namespace CLI {
class App;
}

namespace quiver::app {

/// The subcommands. Each adds itself to the parser; when chosen, it runs while the parser parses, sets `exitCode` (see
/// ExitCode), or throws.
void addOptimizeCommand(CLI::App& parser, int& exitCode);
void addInfoCommand(CLI::App& parser, int& exitCode);
void addListCommand(CLI::App& parser, int& exitCode);
void addConvertCommand(CLI::App& parser, int& exitCode);
void addSimulateCommand(CLI::App& parser, int& exitCode);
void addPlotCommand(CLI::App& parser, int& exitCode);
void addEvaluateCommand(CLI::App& parser, int& exitCode);
void addCheckCommand(CLI::App& parser, int& exitCode);

}  // namespace quiver::app
