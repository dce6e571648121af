#pragma once

/// \file
/// The functions of an angle that the groups' exponentials and Jacobians are made of.

#include <quiver/geometry/scalar/scalar.h>

namespace quiver {

/// Even functions of a rotation angle theta, given t = theta^2, without a singularity at zero.
///
/// Below theta = 1 rad they are power series whose remainder is under 1e-17; above, closed forms in the half angle
/// that lose at most two digits of the coefficient (at 1 rad, where its term is small) and none of the Jacobian. Both
/// sides are smooth, so derivatives by dual numbers are as accurate as values. Valid for theta < 2 pi.
template <class S>
class RotationSeries {
 public:
  explicit RotationSeries(const S& squaredAngle) : t_(squaredAngle), small_(squaredAngle < S(1.0)) {
    using std::sqrt;
    large_ = select(small_, S(1.0), t_);  // harmless where the series is chosen
    theta_ = sqrt(large_);
    const SinCos<S> half = sincos(S(0.5 * theta_));
    sine_ = half.sine;
    cosine_ = half.cosine;
  }

  /// sin(theta/2) / theta
  S halfSinc() const {
    return select(small_,
                  series(0.5, -1.0 / 48, 1.0 / 3840, -1.0 / 645120, 1.0 / 185794560, -1.0 / 81749606400,
                         1.0 / 51011754393600, -1.0 / 42849873690624000),
                  sine_ / theta_);
  }
  /// cos(theta/2)
  S halfCosine() const {
    return select(small_,
                  series(1.0, -1.0 / 8, 1.0 / 384, -1.0 / 46080, 1.0 / 10321920, -1.0 / 3715891200, 1.0 / 1961990553600,
                         -1.0 / 1428329123020800),
                  cosine_);
  }
  /// sin(theta) / theta
  S sinc() const {
    return select(small_,
                  series(1.0, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800, 1.0 / 6227020800,
                         -1.0 / 1307674368000, 1.0 / 355687428096000),
                  2.0 * sine_ * cosine_ / theta_);
  }
  /// a = (1 - cos theta) / theta^2
  S a() const {
    return select(small_,
                  series(1.0 / 2, -1.0 / 24, 1.0 / 720, -1.0 / 40320, 1.0 / 3628800, -1.0 / 479001600,
                         1.0 / 87178291200, -1.0 / 20922789888000, 1.0 / 6402373705728000),
                  2.0 * sine_ * sine_ / large_);
  }
  /// b = (theta - sin theta) / theta^3
  S b() const {
    return select(small_,
                  series(1.0 / 6, -1.0 / 120, 1.0 / 5040, -1.0 / 362880, 1.0 / 39916800, -1.0 / 6227020800,
                         1.0 / 1307674368000, -1.0 / 355687428096000),
                  (theta_ - 2.0 * sine_ * cosine_) / (large_ * theta_));
  }
  /// c = (1 - (theta/2) cot(theta/2)) / theta^2
  S c() const {
    return select(small_,
                  series(bernoulli(1), bernoulli(2), bernoulli(3), bernoulli(4), bernoulli(5), bernoulli(6),
                         bernoulli(7), bernoulli(8), bernoulli(9), bernoulli(10)),
                  closedC());
  }
  /// 2 da/dt
  S slopeOfA() const {
    return select(small_,
                  series(-2.0 / 24, 4.0 / 720, -6.0 / 40320, 8.0 / 3628800, -10.0 / 479001600, 12.0 / 87178291200,
                         -14.0 / 20922789888000, 16.0 / 6402373705728000),
                  2.0 * (sine_ * cosine_ / theta_ - 2.0 * sine_ * sine_ / large_) / large_);
  }
  /// 2 db/dt
  S slopeOfB() const {
    return select(small_,
                  series(-2.0 / 120, 4.0 / 5040, -6.0 / 362880, 8.0 / 39916800, -10.0 / 6227020800,
                         12.0 / 1307674368000, -14.0 / 355687428096000, 16.0 / 121645100408832000),
                  (2.0 * sine_ * sine_ / large_ - 3.0 * (theta_ - 2.0 * sine_ * cosine_) / (large_ * theta_)) / large_);
  }
  /// 2 dc/dt
  S slopeOfC() const {
    const S cot = 0.5 * theta_ * cosine_ / sine_;
    return select(
        small_,
        series(2 * bernoulli(2), 4 * bernoulli(3), 6 * bernoulli(4), 8 * bernoulli(5), 10 * bernoulli(6),
               12 * bernoulli(7), 14 * bernoulli(8), 16 * bernoulli(9), 18 * bernoulli(10), 20 * bernoulli(11)),
        (0.25 / (sine_ * sine_) - cot / large_ - 2.0 * closedC()) / large_);
  }

 private:
  template <class... Rest>
  S series(double first, Rest... rest) const {
    if constexpr (sizeof...(rest) == 0) {
      return S(first);
    } else {
      return series(rest...) * t_ + first;
    }
  }
  S closedC() const { return (S(1.0) - 0.5 * theta_ * cosine_ / sine_) / large_; }
  /// |B_2k| / (2k)!
  static constexpr double bernoulli(int k) {
    constexpr double numbers[] = {1.0 / 12,
                                  1.0 / 720,
                                  1.0 / 30240,
                                  1.0 / 1209600,
                                  1.0 / 47900160,
                                  691.0 / 1307674368000,
                                  1.0 / 74724249600,
                                  3617.0 / 10670622842880000,
                                  43867.0 / 5109094217170944000,
                                  174611.0 / 802857662698291200000.0,
                                  77683.0 / 14101100039391805440000.0};
    return numbers[k - 1];
  }

  S t_;
  MaskOf<S> small_;
  S large_, theta_, sine_, cosine_;
};

}  // namespace quiver
