#include <quiver/core/algorithm/diagnosis.h>

#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <quiver/core/algorithm/gauge.h>
#include <quiver/core/algorithm/null_space.h>

namespace quiver {
namespace {

/// The diagonal block of a variable in H, by products with unit vectors.
Eigen::MatrixXd diagonalBlock(const Problem& problem, const LinearSystem& system, int variable) {
  const int n = problem.dimension(variable);
  std::vector<double> x(static_cast<std::size_t>(problem.scalars()), 0.0);
  std::vector<double> y(x.size());
  Eigen::MatrixXd block(n, n);
  for (int c = 0; c < n; ++c) {
    const auto at = static_cast<std::size_t>(problem.offset(variable) + c);
    x[at] = 1.0;
    system.multiply(x, y);
    x[at] = 0.0;
    for (int r = 0; r < n; ++r) block(r, c) = y[static_cast<std::size_t>(problem.offset(variable) + r)];
  }
  return block;
}

/// "x [m]" for a direction along an axis, "0.71 x [m] - 0.71 y [m]" for one between them.
std::string describeDirection(const Eigen::VectorXd& direction, const std::vector<std::string>& names) {
  std::string text;
  for (int i = 0; i < direction.size(); ++i) {
    const double part = direction[i];
    if (std::abs(part) < 0.05) continue;
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (std::abs(part) > 0.995) return name;
    text += text.empty() ? (part < 0.0 ? "-" : "") : (part < 0.0 ? " - " : " + ");
    text += fmt::format("{:.2f} {}", std::abs(part), name);
  }
  return text;
}

std::string describeEdges(const Problem& problem, int slot) {
  std::string text;
  int count = 0;
  for (int b = 0; b < problem.batches(); ++b) {
    for (int i = 0; i < problem.batch(b).size(); ++i) {
      const auto slots = problem.batch(b).slots(i);
      if (std::find(slots.begin(), slots.end(), slot) == slots.end()) continue;
      if (++count > 4) continue;
      text += text.empty() ? "" : ", ";
      text += problem.edgeType(b).tag();
      for (const std::int32_t other : slots) text += fmt::format(" {}", problem.vertex(other).id());
    }
  }
  if (count > 4) text += fmt::format(" and {} more", count - 4);
  return fmt::format("its {} edge{}: {}", count, count == 1 ? "" : "s", text);
}

/// Directions in which no edge constrains the variable, the others held; empty if there are none.
std::vector<std::string> looseDirections(const Problem& problem, const LinearSystem& system, int variable) {
  const Eigen::MatrixXd block = diagonalBlock(problem, system, variable);
  std::vector<std::string> loose;
  if (!block.allFinite()) return loose;
  // Coordinates are scaled by their own diagonal, so that metres and radians of very different weight compare.
  const Eigen::VectorXd scale = block.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (scale.array() > 0.0).select(scale.cwiseInverse(), 1.0);
  const Eigen::MatrixXd scaled = inverse.asDiagonal() * block * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const std::vector<std::string> names =
      problem.vertexType(problem.slotOfVariable(variable)).tangentNames(problem.dimension(variable));
  for (int i = 0; i < eigen.eigenvalues().size(); ++i) {
    if (eigen.eigenvalues()[i] > 1e-12) continue;
    const Eigen::VectorXd direction = (inverse.asDiagonal() * eigen.eigenvectors().col(i)).normalized();
    std::string words = describeDirection(direction, names);
    // One edge far heavier than the others leaves many directions that differ by little.
    if (std::find(loose.begin(), loose.end(), words) == loose.end()) loose.push_back(std::move(words));
  }
  return loose;
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : "; ") + word;
  return text;
}

/// The variables that null directions move, by their share vᵀDv.
struct Movement {
  std::vector<int> variables;
  /// Of those of the largest dimension the one of lowest id.
  int anchor = -1;
};

Movement movementOf(const Problem& problem, const std::vector<double>& scale, const NullSpace& space) {
  std::vector<double> share(static_cast<std::size_t>(problem.variables()), 0.0);
  double largest = 0.0;
  for (int v = 0; v < problem.variables(); ++v) {
    double& sum = share[static_cast<std::size_t>(v)];
    for (const std::vector<double>& direction : space.directions) {
      for (int c = 0; c < problem.dimension(v); ++c) {
        const auto at = static_cast<std::size_t>(problem.offset(v) + c);
        sum += scale[at] * scale[at] * direction[at] * direction[at];
      }
    }
    largest = std::max(largest, sum);
  }
  Movement result;
  const auto idOf = [&](int v) { return problem.vertex(problem.slotOfVariable(v)).id(); };
  for (int v = 0; v < problem.variables(); ++v) {
    if (share[static_cast<std::size_t>(v)] < 1e-6 * largest) continue;
    result.variables.push_back(v);
    const int best = result.anchor;
    if (best < 0 || problem.dimension(v) > problem.dimension(best) ||
        (problem.dimension(v) == problem.dimension(best) && idOf(v) < idOf(best)))
      result.anchor = v;
  }
  return result;
}

/// The directions in which the null space moves one variable, in the names of its tangent.
std::vector<std::string> directionsOf(const Problem& problem, const std::vector<double>& scale, const NullSpace& space,
                                      int variable) {
  const int n = problem.dimension(variable);
  Eigen::MatrixXd moved(n, static_cast<Eigen::Index>(space.directions.size()));
  Eigen::VectorXd scales(n);
  for (int r = 0; r < n; ++r) {
    const auto at = static_cast<std::size_t>(problem.offset(variable) + r);
    scales[r] = scale[at];
    for (int c = 0; c < moved.cols(); ++c) moved(r, c) = scales[r] * space.directions[static_cast<std::size_t>(c)][at];
  }
  const std::vector<std::string> names =
      problem.vertexType(problem.slotOfVariable(variable)).tangentNames(problem.dimension(variable));
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(moved, Eigen::ComputeThinU);
  const Eigen::Index rank = (svd.singularValues().array() > 1e-4 * svd.singularValues()[0]).count();
  if (rank == n) return names;
  std::vector<std::string> directions;
  for (Eigen::Index k = 0; k < rank; ++k) {
    const Eigen::VectorXd direction = svd.matrixU().col(k).cwiseQuotient(scales).normalized();
    std::string words = describeDirection(direction, names);
    if (std::find(directions.begin(), directions.end(), words) == directions.end())
      directions.push_back(std::move(words));
  }
  return directions;
}

/// What the null vectors of H say, for vertex types that supply no generators and for weak spots that are no gauge;
/// empty if there are none.
std::string describeNullSpace(const Problem& problem, LinearSystem& system, std::string_view damping) {
  const NullSpace space = findNullSpace(problem, system, {});
  if (space.directions.empty()) return {};
  const auto diagonal = system.diagonal();
  std::vector<double> scale(diagonal.size());
  for (std::size_t i = 0; i < scale.size(); ++i) scale[i] = std::sqrt(std::max(diagonal[i], 1e-300));
  const Movement movement = movementOf(problem, scale, space);
  const int slot = problem.slotOfVariable(movement.anchor);
  const std::size_t others = movement.variables.size() - 1;
  return fmt::format(
      "vertex {} ({}) is not constrained in: {}{}; the system has {} null direction{}; {}; add measurements, or fix it "
      "with --fix {}{}",
      problem.vertex(slot).id(), problem.vertexType(slot).tag(),
      join(directionsOf(problem, scale, space, movement.anchor)),
      others == 0 ? "" : fmt::format(", moving together with {} other vert{}", others, others == 1 ? "ex" : "ices"),
      space.directions.size(), space.directions.size() == 1 ? "" : "s", describeEdges(problem, slot),
      problem.vertex(slot).id(), damping);
}

}  // namespace

std::string diagnoseFailure(const Problem& problem, LinearSystem& system, const LinearOutcome& outcome, bool damped) {
  const std::string_view damping = damped ? "" : ", or use --algorithm lm";
  if (outcome.kind == LinearOutcome::Kind::memoryLimit)
    return "the linear solver would need more memory than it may use";
  if (outcome.kind == LinearOutcome::Kind::notConverged) {
    return fmt::format("the iterative linear solver did not converge in {} iterations; try --solver block",
                       outcome.iterations);
  }
  // The failed pivot may be a neighbour of the vertex at fault: look at every vertex for one that its own edges leave
  // loose.
  std::vector<int> candidates;
  if (outcome.variable >= 0) candidates.push_back(outcome.variable);
  const auto diagonal = system.diagonal();
  constexpr int mostBlocks = 2000;
  for (int v = 0; v < problem.variables() && static_cast<int>(candidates.size()) < mostBlocks; ++v) {
    for (int c = 0; c < problem.dimension(v); ++c) {
      if (!(diagonal[static_cast<std::size_t>(problem.offset(v) + c)] > 0.0)) {
        candidates.insert(candidates.begin(), v);
        break;
      }
    }
  }
  for (const int variable : candidates) {
    const std::vector<std::string> loose = looseDirections(problem, system, variable);
    if (loose.empty()) continue;
    const int slot = problem.slotOfVariable(variable);
    return fmt::format("vertex {} ({}) is not constrained in {} direction{}: {}; {}; add a measurement, or fix it{}",
                       problem.vertex(slot).id(), problem.vertexType(slot).tag(), loose.size(),
                       loose.size() == 1 ? "" : "s", join(loose), describeEdges(problem, slot), damping);
  }
  for (const ComponentGauge& gauge : findGauges(problem)) {
    if (gauge.free == 0) continue;
    const int slot = problem.slotOfVariable(gauge.anchor);
    return fmt::format(
        "a component of {} vertices may move as a whole in {} direction{} that no error resists at these "
        "estimates: fix "
        "vertex {} ({}; {}) "
        "with --fix {}{}{}",
        gauge.variables.size(), gauge.free, gauge.free == 1 ? "" : "s", problem.vertex(slot).id(),
        problem.vertexType(slot).tag(), join(problem.vertexType(slot).tangentNames(problem.dimension(gauge.anchor))),
        problem.vertex(slot).id(), problem.anyHeldDirections() ? "" : ", or use --gauge fix", damping);
  }
  if (std::string found = describeNullSpace(problem, system, damping); !found.empty()) return found;
  if (outcome.variable < 0) return "the linear system is not positive definite";
  const int slot = problem.slotOfVariable(outcome.variable);
  const std::vector<std::string> names = problem.vertexType(slot).tangentNames(problem.dimension(outcome.variable));
  return fmt::format(
      "the linear system is not positive definite: at vertex {} ({}), direction {}, the pivot is {:.3g}; together with "
      "its neighbours it "
      "is not constrained there; {}; add measurements{}",
      problem.vertex(slot).id(), problem.vertexType(slot).tag(),
      outcome.coordinate >= 0 ? names[static_cast<std::size_t>(outcome.coordinate)] : "unknown", outcome.pivot,
      describeEdges(problem, slot), damping);
}

std::string describeBadJacobian(const Problem& problem) {
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    PanelBuffer buffer(batch.largestShape(), true, 1);
    for (std::int32_t i = 0; i < batch.size(); ++i) {
      batch.linearize(problem.state(), {&i, 1}, buffer.panel());
      const RobustKernel& kernel = batch.edge(i).robustKernel();
      if (!std::isfinite(kernel.evaluate(buffer.panel().squaredError[0]).weight)) {
        return fmt::format("robust kernel {} gives edge {} {} a weight that is not finite", kernel.name(),
                           problem.edgeType(b).tag(), fmt::join(batch.edge(i).vertexIds(), " "));
      }
      const EdgeShape shape = batch.shape(i);
      for (std::size_t role = 0; role < shape.columns.size(); ++role) {
        for (int k = 0; k < shape.rows * shape.columns[role]; ++k) {
          if (std::isfinite(buffer.panel().jacobian[role][k * Panel::lanes])) continue;
          return fmt::format("the Jacobian of edge {} {} is not finite; is its error smooth where it stands?",
                             problem.edgeType(b).tag(), fmt::join(batch.edge(i).vertexIds(), " "));
        }
      }
    }
  }
  return "the gradient is not finite, though the Jacobians are: its numbers are too large";
}

}  // namespace quiver
