#include <quiver/core/graph/robust_kernel.h>

#include <cmath>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver {
namespace {

RobustValue huber(double e, double width, double) {
  const double square = width * width;
  if (e <= square) return {e, 1.0, 0.0};
  const double root = std::sqrt(e);
  const double weight = width / root;
  return {2.0 * width * root - square, weight, -0.5 * weight / e};
}

RobustValue cauchy(double e, double width, double) {
  const double square = width * width;
  const double weight = 1.0 / (1.0 + e / square);
  return {square * std::log1p(e / square), weight, -weight * weight / square};
}

RobustValue tukey(double e, double width, double) {
  const double square = width * width;
  if (e > square) return {square / 3.0, 0.0, 0.0};
  const double ratio = e / square;
  const double rest = 1.0 - ratio;
  // δ²/3 (1 − (1 − r)³) without its cancellation.
  return {e * (1.0 - ratio * (1.0 - ratio / 3.0)), rest * rest, -2.0 * rest / square};
}

constexpr RobustKernelType huberType{"Huber", huber,
                                     "width in standard deviations: e, beyond it 2 width sqrt(e) - width^2"};
constexpr RobustKernelType cauchyType{"Cauchy", cauchy, "width in standard deviations: width^2 ln(1 + e / width^2)"};
constexpr RobustKernelType tukeyType{
    "Tukey", tukey, "width in standard deviations: width^2/3 (1 - (1 - e/width^2)^3), constant beyond it"};

}  // namespace

RobustKernel::RobustKernel(const RobustKernelType& type, double width, double shape)
    : type_(&type), width_(width), shape_(shape) {
  if (!(width > 0.0) || !std::isfinite(width) || !std::isfinite(shape)) {
    throw GraphError(fmt::format("robust kernel {}: width {} and shape {}; the width must be positive, both finite",
                                 type.name, width, shape));
  }
}

const RobustKernelType& huberKernel() { return huberType; }
const RobustKernelType& cauchyKernel() { return cauchyType; }
const RobustKernelType& tukeyKernel() { return tukeyType; }

}  // namespace quiver
