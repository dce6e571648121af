#include <quiver/core/util/chi_squared.h>

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// x^a e^−x / Γ(a), without overflow.
double gammaFactor(double a, double x) { return std::exp(a * std::log(x) - x - std::lgamma(a)); }

/// P(a, x) for x < a + 1: x^a e^−x Σ xⁿ / (a (a+1) … (a+n)) / Γ(a).
double lowerSeries(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (double n = a + 1.0; term > 0.25 * epsilon * sum; n += 1.0) {
    term *= x / n;
    sum += term;
  }
  return sum * gammaFactor(a, x);
}

/// Q(a, x) for x ≥ a + 1: the continued fraction 1/(x+1−a− 1(1−a)/(x+3−a− 2(2−a)/(x+5−a− …))), evaluated forwards
/// by the method of Lentz.
double upperFraction(double a, double x) {
  constexpr double tiny = 1e-300;
  double b = x + 1.0 - a;
  double c = 1.0 / tiny;
  double d = 1.0 / b;
  double value = d;
  for (int n = 1; n < 100000; ++n) {
    const double numerator = -n * (n - a);
    b += 2.0;
    d = numerator * d + b;
    if (std::abs(d) < tiny) d = tiny;
    c = b + numerator / c;
    if (std::abs(c) < tiny) c = tiny;
    d = 1.0 / d;
    const double factor = d * c;
    value *= factor;
    if (std::abs(factor - 1.0) < epsilon) break;
  }
  return value * gammaFactor(a, x);
}

void demandDimension(int dimension) {
  if (dimension < 1) throw GraphError(fmt::format("chi-squared of {} dimensions: there must be at least 1", dimension));
}

}  // namespace

double chiSquaredTail(double value, int dimension) {
  demandDimension(dimension);
  if (!(value >= 0.0)) throw GraphError(fmt::format("chi-squared at {}: it must be 0 or more", value));
  if (value == 0.0) return 1.0;
  const double a = 0.5 * dimension;
  const double x = 0.5 * value;
  if (std::isinf(x)) return 0.0;
  return x < a + 1.0 ? 1.0 - lowerSeries(a, x) : upperFraction(a, x);
}

double chiSquaredQuantile(double probability, int dimension) {
  demandDimension(dimension);
  if (!(probability > 0.0) || !(probability < 1.0))
    throw GraphError(fmt::format("a probability of {}: it must lie between 0 and 1", probability));
  const double a = 0.5 * dimension;
  // Compared on the side where nothing cancels: P below the mean, Q above.
  const auto tooSmall = [&](double value) {
    const double x = 0.5 * value;
    return x < a + 1.0 ? lowerSeries(a, x) < probability : upperFraction(a, x) > 1.0 - probability;
  };
  double high = dimension + 2.0;
  while (tooSmall(high)) high *= 2.0;
  double low = 0.0;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (tooSmall(middle) ? low : high) = middle;
  }
}

}  // namespace quiver
