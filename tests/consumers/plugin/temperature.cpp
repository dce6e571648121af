// A plugin: rooms that have a temperature, thermometers in some of them, draughts between them, a linear solver and an
// algorithm.
#include <algorithm>
#include <array>
#include <vector>

#include <quiver/core/algorithm/descent.h>
#include <quiver/quiver.h>
#include <quiver/solvers/normal_equations.h>

#include "conjugate_gradient.h"

namespace {

using quiver::Vector;

class VertexTemperature : public quiver::BaseVertex<VertexTemperature, 1, double> {
 public:
  template <typename S>
  static S oplus(const S& x, const Vector<S, 1>& delta) {
    return x + delta[0];
  }
  static constexpr std::array tangent{"temperature [K]"};
};

class EdgeReading : public quiver::BaseEdge<EdgeReading, 1, double, VertexTemperature> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const S& reading, const S& room) {
    return Vector<S, 1>(room - reading);
  }
};

class EdgeDraught : public quiver::BaseEdge<EdgeDraught, 1, double, VertexTemperature, VertexTemperature> {
 public:
  static constexpr bool lanes = true;
  template <typename S>
  static Vector<S, 1> computeError(const S& difference, const S& from, const S& to) {
    return Vector<S, 1>(to - from - difference);
  }
};

/// Steepest descent in the scale of H's diagonal, as far as the quadratic model says.
void steepestDescent(quiver::Descent& descent) {
  std::vector<double>& step = descent.delta();
  std::vector<double>& product = descent.scratch(0);
  while (!descent.exhausted()) {
    const auto gradient = descent.system().gradient();
    const auto diagonal = descent.system().diagonal();
    for (std::size_t i = 0; i < step.size(); ++i) step[i] = -gradient[i] / std::max(diagonal[i], 1e-12);
    descent.system().multiply(step, product);
    double slope = 0.0, curvature = 0.0;
    for (std::size_t i = 0; i < step.size(); ++i) {
      slope += gradient[i] * step[i];
      curvature += product[i] * step[i];
    }
    if (curvature <= 0.0) return descent.finish(quiver::Status::stalled, "the cost does not curve downhill");
    for (double& number : step) number *= -slope / curvature;
    const quiver::CostTotals trial = descent.tryStep();
    if (!(trial.cost <= descent.totals().cost)) {
      descent.reject();
      return descent.finish(quiver::Status::stalled, "the steepest step does not lower the cost");
    }
    if (descent.accept(trial)) return;
  }
}

void registerTemperature(quiver::Registry& registry) {
  registry.addVertex<VertexTemperature>("VERTEX_TEMPERATURE", "A room's temperature.");
  registry.addEdge<EdgeReading>("EDGE_READING", "A thermometer in a room.");
  registry.addEdge<EdgeDraught>("EDGE_DRAUGHT", "A draught: the difference between two rooms.");
  registry.addLinearSystem(
      "conjugate_gradient", "Conjugate gradients with the diagonal as preconditioner.",
      [](const quiver::Options&) { return std::make_unique<quiver::NormalEquations>(makeConjugateGradient()); });
  registry.addAlgorithm("steepest", "Steepest descent.", {steepestDescent, true});
}

}  // namespace

QUIVER_PLUGIN(registerTemperature);
