#pragma once

#include <span>
#include <vector>

#include <quiver/core/problem/problem.h>

namespace quiver {

/// D, the diagonal of H with a memory, kept between bounds, by which damped steps measure: whatever the units of a
/// coordinate, since bounds are shares of the largest entry that the same coordinate has among vertices of the same
/// type. Directions that nothing measures are damped so, and huge entries do not overflow.
///
/// Entries shrink by half a step at most, and not at all after a step that brought little: where a derivative goes
/// through zero, a step measured by it alone is the longer the less it can bring, and the descent would stay there. To
/// keep the largest entry for ever (Moré, "The Levenberg–Marquardt algorithm: implementation and theory", 1978) costs
/// bundle adjustment many steps: points that were near a camera at first stay stiff.
class DampingScale {
 public:
  explicit DampingScale(const Problem& problem);

  /// Forgets what was met: a descent begins.
  void restart();
  /// Takes the diagonal of H, in the order of variables, after a step that brought `ratio` of what it promised.
  void update(std::span<const double> diagonal, double ratio = 1.0);
  /// The most that an entry of D exceeds its entry of H, 1 if none does: what is damped by λ D may hardly move because
  /// of the memory alone.
  double excess() const { return excess_; }
  /// out ← λ D, on at most so many threads.
  void scale(double lambda, int threads, std::span<double> out) const;

 private:
  /// Variables that share bounds.
  struct Class {
    std::size_t begin;  // scalars
    std::size_t end;
    std::size_t dimension;
    std::size_t bounds;  // the first of their least entries
  };
  void scaleRange(const Class& own, double lambda, std::size_t begin, std::size_t end, std::span<double> out) const;

  std::vector<Class> classes_;
  std::vector<double> least_;
  std::vector<double> remembered_;  // of each scalar
  double excess_ = 1.0;
};

}  // namespace quiver
