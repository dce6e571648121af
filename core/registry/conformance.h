#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <quiver/core/registry/registry.h>

namespace quiver {

/// A promise that a type breaks.
struct ConformanceFinding {
  /// Of the type, or the name of the robust kernel.
  std::string tag;
  /// "jacobians", "oplus", "fields", "round trip", "robust kernel".
  std::string check;
  std::string message;
};

struct ConformanceOptions {
  /// Types to check, by tag; all of the registry's, and its robust kernels, if empty.
  std::vector<std::string> tags;
  /// Random elements of each type.
  int draws = 12;
  std::uint64_t seed = 1;
  /// Largest deviation of a Jacobian's entry from differences, as JacobianEntry measures it.
  double jacobianTolerance = 1e-6;
  /// Tags of edges whose Jacobians are approximations on purpose: not compared.
  std::vector<std::string> approximateJacobians;
};

/// Under which moves of the whole world an edge type's chi2 stays.
struct WorldInvariance {
  std::string tag;
  /// Bit k for `GaugeDirection` k; 0 also where a vertex type supplies no generators.
  std::uint32_t directions = 0;
};

struct ConformanceReport {
  int types = 0;
  std::int64_t checks = 0;
  std::vector<ConformanceFinding> findings;
  std::vector<WorldInvariance> invariances;

  bool passed() const { return findings.empty(); }
  /// One line a finding, then the counts.
  std::string describe() const;
};

/// Checks that the types of a registry keep what the library relies on, through their descriptors alone, so those of
/// plugins as well, on made-up elements:
/// - vertices: x ⊞ 0 = x; ⊞ in place gives the same bits; its directions are independent; as many names as directions;
/// - edges: Jacobians agree with differences at random estimates, near a vanishing error and with rotations within 1e-4
///   of π (never across it), where initialEstimate makes it possible; which moves of the world leave chi2 as it is;
/// - all: what is written reads back to the same bits, and `fields()` counts it right.
/// - robust kernels: ρ(0) = 0, ρ'(0) = 1, all numbers finite, ρ' and ρ'' the derivatives, many at once as one by one.
/// Types must be readable from random numbers (see RandomReader in field_tokens.h); those that are not become findings.
/// Estimates of run-time size have three numbers.
ConformanceReport checkConformance(std::shared_ptr<const Registry> registry, const ConformanceOptions& options = {});

/// Checks robust kernels alone, by name, and adds what is found to a report. Throws GraphError for an unknown name.
void checkKernels(const Registry& registry, const std::vector<std::string>& names, ConformanceReport& report);

}  // namespace quiver
