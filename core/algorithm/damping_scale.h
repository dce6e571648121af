#pragma once

#include <span>
#include <vector>

#include <quiver/core/problem/problem.h>

namespace quiver {

/// D, the diagonal of H kept between bounds, by which damped steps measure: whatever the units of a coordinate, since
/// bounds are shares of the largest entry that the same coordinate has among vertices of the same type. Directions that
/// nothing measures are damped so, and huge entries do not overflow.
class DampingScale {
 public:
  explicit DampingScale(const Problem& problem);

  /// Takes the diagonal of H, in the order of variables, which must stay as it is until the next call.
  void update(std::span<const double> diagonal);
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
  std::span<const double> diagonal_;
};

}  // namespace quiver
