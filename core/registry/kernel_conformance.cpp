#include <quiver/core/registry/kernel_conformance.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include <quiver/core/registry/conformance.h>
#include <quiver/core/util/error.h>

namespace quiver {
namespace {

/// A derivative by differences, and how far it can be from the true one: two steps and their disagreement, and what
/// rounding leaves of numbers as large as `size`.
struct Slope {
  double value;
  double uncertainty;
};

template <typename Function>
Slope slopeOf(const Function& f, double at, double size) {
  const double h = 1e-4 * at;
  const auto difference = [&](double step) { return (f(at + step) - f(at - step)) / (2.0 * step); };
  const double wide = difference(h), narrow = difference(0.5 * h);
  const double rounding = (1e-12 * (std::abs(f(at)) + at) + 1e-15 * size) / h;
  return {narrow, 2.0 * std::abs(wide - narrow) + rounding};
}

bool agrees(double value, const Slope& slope) {
  return std::abs(value - slope.value) <= 1e-6 * std::abs(value) + slope.uncertainty;
}

std::string brokenAtZero(const RobustKernel& kernel) {
  const RobustValue zero = kernel.evaluate(0.0);
  if (zero.rho == 0.0 && std::abs(zero.weight - 1.0) <= 1e-12) return "";
  return fmt::format("at 0, width {}, rho is {:.9g} and its derivative {:.9g}; they must be 0 and 1", kernel.width(),
                     zero.rho, zero.weight);
}

std::string brokenAt(const RobustKernel& kernel, double squaredError) {
  const RobustValue value = kernel.evaluate(squaredError);
  const std::string where = fmt::format("at squared error {:.6g}, width {}, ", squaredError, kernel.width());
  if (!std::isfinite(value.rho) || !std::isfinite(value.weight) || !std::isfinite(value.second)) {
    return where + fmt::format("rho and its derivatives are {}, {}, {}; they must be finite", value.rho, value.weight,
                               value.second);
  }
  if (value.weight < 0.0) return where + fmt::format("the weight is {:.9g}; it must not be negative", value.weight);
  // Formulas like w² log(1 + e/w²) round as w² does, however small e is.
  const double size = kernel.type()->squaredWidth ? kernel.width() : kernel.width() * kernel.width();
  const Slope first = slopeOf([&](double e) { return kernel.evaluate(e).rho; }, squaredError, size);
  if (!agrees(value.weight, first))
    return where + fmt::format("the weight is {:.9g}, the slope of rho {:.9g}", value.weight, first.value);
  const Slope second = slopeOf([&](double e) { return kernel.evaluate(e).weight; }, squaredError, 1.0);
  if (!agrees(value.second, second))
    return where +
           fmt::format("the second derivative is {:.9g}, the slope of the weight {:.9g}", value.second, second.value);
  return "";
}

/// `evaluateAll` against `evaluate`.
std::string brokenTogether(const RobustKernel& kernel, const std::vector<double>& squaredErrors) {
  std::vector<double> rho(squaredErrors.size()), weight = rho, second = rho;
  kernel.evaluate(squaredErrors, {rho.data(), weight.data(), second.data()});
  const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-12 * (std::abs(a) + std::abs(b)); };
  for (std::size_t i = 0; i < rho.size(); ++i) {
    const RobustValue one = kernel.evaluate(squaredErrors[i]);
    if (same(rho[i], one.rho) && same(weight[i], one.weight) && same(second[i], one.second)) continue;
    return fmt::format("many at once differ from one at squared error {:.6g}: {:.9g}, {:.9g}, {:.9g}", squaredErrors[i],
                       rho[i], weight[i], second[i]);
  }
  return "";
}

}  // namespace

std::string brokenKernelPromise(const RobustKernelType& type) {
  std::vector<double> squaredErrors;
  for (double e = 1.3e-4; e < 1e8; e *= 1.7) squaredErrors.push_back(e);
  for (const double width : {0.1, 1.0, 2.7, 100.0}) {
    const RobustKernel kernel(type, width);
    std::string broken = brokenAtZero(kernel);
    for (std::size_t i = 0; broken.empty() && i < squaredErrors.size(); ++i)
      broken = brokenAt(kernel, squaredErrors[i]);
    if (broken.empty()) broken = brokenTogether(kernel, squaredErrors);
    if (!broken.empty()) return broken;
  }
  return "";
}

void checkKernels(const Registry& registry, const std::vector<std::string>& names, ConformanceReport& report) {
  for (const std::string& name : names) {
    const RobustKernelType* kernel = registry.findRobustKernel(name);
    if (kernel == nullptr) throw GraphError(fmt::format("no robust kernel '{}'", name));
    ++report.checks;
    std::string broken;
    try {
      broken = brokenKernelPromise(*kernel);
    } catch (const std::exception& error) {
      broken = fmt::format("it throws: {}", error.what());
    }
    if (!broken.empty()) report.findings.push_back({name, "robust kernel", broken});
  }
}

}  // namespace quiver
