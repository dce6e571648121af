#pragma once

#include <memory>

#include <quiver/solvers/backends/linear_solver.h>

/// Conjugate gradients with the diagonal as preconditioner.
std::unique_ptr<quiver::LinearSolver> makeConjugateGradient();
