#include <quiver/core/algorithm/damping_scale.h>

#include <algorithm>

#include <quiver/core/util/pieces.h>

namespace quiver {
namespace {

/// Least entry of D as a share of the largest of its coordinate, and the largest number.
constexpr double leastShare = 1e-14;
constexpr double most = 1e32;
/// What rounding leaves of a coordinate that moves no error, as a share of the largest entry of any coordinate of the
/// type: a derivative of 3e-15 of another. Units differ by less.
constexpr double rounding = 1e-29;
/// Where no vertex of the type is measured in any coordinate, any positive number keeps them in place.
constexpr double unmeasured = 1.0;
/// What an entry keeps of itself at least after a step, and the share of a promise below which it keeps all.
constexpr double mostShrinking = 0.5;
constexpr double littleGain = 0.25;
/// Bounds are repeated so often that loops over several variables are loops over vectors.
constexpr std::size_t repeats = 8;

}  // namespace

DampingScale::DampingScale(const Problem& problem) {
  for (const Problem::Run& run : problem.runs()) {
    const auto dimension = static_cast<std::size_t>(problem.dimension(run.begin));
    const auto begin = static_cast<std::size_t>(problem.offset(run.begin));
    const auto count = static_cast<std::size_t>(run.end - run.begin);
    classes_.push_back({begin, begin + count * dimension, dimension, least_.size()});
    least_.resize(least_.size() + repeats * dimension);
  }
  remembered_.resize(static_cast<std::size_t>(problem.scalars()));
}

void DampingScale::restart() { std::fill(remembered_.begin(), remembered_.end(), 0.0); }

void DampingScale::update(std::span<const double> diagonal, double ratio) {
  const double memory = ratio < littleGain ? 1.0 : mostShrinking;
  excess_ = 1.0;
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    remembered_[i] = std::max(memory * remembered_[i], diagonal[i]);
    if (diagonal[i] > 0.0 && remembered_[i] > excess_ * diagonal[i]) excess_ = remembered_[i] / diagonal[i];
  }
  for (const Class& own : classes_) {
    const std::size_t period = repeats * own.dimension;
    double* const bounds = least_.data() + own.bounds;
    std::fill_n(bounds, period, 0.0);
    for (std::size_t begin = own.begin; begin < own.end; begin += period) {
      const std::size_t count = std::min(period, own.end - begin);
      for (std::size_t k = 0; k < count; ++k) bounds[k] = std::max(bounds[k], remembered_[begin + k]);
    }
    const double ofAll = *std::max_element(bounds, bounds + period);
    for (std::size_t c = 0; c < own.dimension; ++c) {
      double largest = 0.0;
      for (std::size_t k = c; k < period; k += own.dimension) largest = std::max(largest, bounds[k]);
      // A coordinate that nothing measures is as stiff as the best measured one.
      const bool measured = largest > rounding * ofAll;
      const double least = measured      ? std::min(most, leastShare * largest)
                           : ofAll > 0.0 ? std::min(most, ofAll)
                                         : unmeasured;
      for (std::size_t k = c; k < period; k += own.dimension) bounds[k] = least;
    }
  }
}

void DampingScale::scale(double lambda, int threads, std::span<double> out) const {
  const auto part = [&](std::size_t begin, std::size_t end) {
    for (const Class& own : classes_) scaleRange(own, lambda, std::max(begin, own.begin), std::min(end, own.end), out);
    return true;
  };
  overPieces(out.size(), threads, part, [](bool a, bool b) { return a && b; });
}

void DampingScale::scaleRange(const Class& own, double lambda, std::size_t begin, std::size_t end,
                              std::span<double> out) const {
  const std::size_t period = repeats * own.dimension;
  const double* const bounds = least_.data() + own.bounds;
  while (begin < end) {
    const std::size_t place = (begin - own.begin) % period;
    const std::size_t count = std::min(period - place, end - begin);
    for (std::size_t k = 0; k < count; ++k)
      out[begin + k] = lambda * std::clamp(remembered_[begin + k], bounds[place + k], most);
    begin += count;
  }
}

}  // namespace quiver
