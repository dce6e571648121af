#pragma once

namespace quiver {

/// The probability that a χ²-distributed squared error of `dimension` degrees of freedom exceeds `value`: the p-value
/// of a residual. Relative error about 1e-13, also far out in the tail. Throws GraphError unless dimension ≥ 1 and
/// value ≥ 0. Source: the regularised incomplete gamma function Q(dimension/2, value/2), by its power series below the
/// mean and its continued fraction above.
double chiSquaredTail(double value, int dimension);

/// The squared error that stays below it with that probability: the inverse of 1 − chiSquaredTail. Throws GraphError
/// unless 0 < probability < 1 and dimension ≥ 1.
double chiSquaredQuantile(double probability, int dimension);

}  // namespace quiver
