// A plugin: rooms that have a temperature, thermometers in some of them, draughts between them, and a linear solver.
#include <array>

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

void registerTemperature(quiver::Registry& registry) {
  registry.addVertex<VertexTemperature>("VERTEX_TEMPERATURE", "A room's temperature.");
  registry.addEdge<EdgeReading>("EDGE_READING", "A thermometer in a room.");
  registry.addEdge<EdgeDraught>("EDGE_DRAUGHT", "A draught: the difference between two rooms.");
  registry.addLinearSystem(
      "conjugate_gradient", "Conjugate gradients with the diagonal as preconditioner.",
      [](const quiver::Options&) { return std::make_unique<quiver::NormalEquations>(makeConjugateGradient()); });
}

}  // namespace

QUIVER_PLUGIN(registerTemperature);
