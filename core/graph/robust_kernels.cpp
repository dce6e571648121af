#include <quiver/core/graph/robust_kernels.h>

#include <cmath>

#include <quiver/core/registry/registry.h>

namespace quiver {
namespace {

/// A kernel over many errors: a loop that the compiler turns into vectors where the kernel has no branch.
template <RobustValue (*kernel)(double, double, double)>
void all(std::span<const double> errors, double width, double shape, const RobustValues& values) {
  if (!values.second) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const RobustValue value = kernel(errors[i], width, shape);
      values.rho[i] = value.rho;
      values.weight[i] = value.weight;
    }
    return;
  }
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const RobustValue value = kernel(errors[i], width, shape);
    values.rho[i] = value.rho;
    values.weight[i] = value.weight;
    values.second[i] = value.second;
  }
}

RobustValue huber(double e, double width, double) {
  const double square = width * width;
  // Both sides are computed and one is chosen: outliers come in no order that a processor could guess.
  const bool inside = e <= square;
  const double root = std::sqrt(e);
  const double weight = width / root;
  const double rho = 2.0 * width * root - square;
  const double second = -0.5 * weight / e;
  return {inside ? e : rho, inside ? 1.0 : weight, inside ? 0.0 : second};
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

RobustValue pseudoHuber(double e, double width, double) {
  const double square = width * width;
  const double ratio = e / square;
  const double root = std::sqrt(1.0 + ratio);
  // √(1 + r) − 1 = r / (√(1 + r) + 1): no cancellation for small r.
  return {2.0 * square * ratio / (root + 1.0), 1.0 / root, -0.5 / (square * root * (1.0 + ratio))};
}

RobustValue gemanMcClure(double e, double width, double) {
  const double share = width / (width + e);
  return {share * e, share * share, -2.0 * share * share / (width + e)};
}

RobustValue welsch(double e, double width, double) {
  const double square = width * width;
  const double weight = std::exp(-e / square);
  return {-square * std::expm1(-e / square), weight, -weight / square};
}

RobustValue fair(double e, double width, double) {
  const double ratio = std::sqrt(e) / width;
  const double weight = 1.0 / (1.0 + ratio);
  // ratio − ln(1 + ratio) cancels for small ratios: there its series.
  const double small = ratio * ratio * (0.5 - ratio * (1.0 / 3.0 - ratio * (0.25 - ratio * (0.2 - ratio / 6.0))));
  const double loss = ratio < 1e-3 ? small : ratio - std::log1p(ratio);
  const double second = e > 0.0 ? -0.5 * weight * weight / (width * std::sqrt(e)) : 0.0;
  return {2.0 * width * width * loss, weight, second};
}

RobustValue saturated(double e, double width, double) {
  const double square = width * width;
  if (e <= square) return {e, 1.0, 0.0};
  return {square, 0.0, 0.0};
}

RobustValue dcs(double e, double width, double) {
  if (e <= width) return {e, 1.0, 0.0};
  const double scale = 2.0 * width / (width + e);
  return {width * (3.0 * e - width) / (width + e), scale * scale, -2.0 * scale * scale / (width + e)};
}

RobustValue barron(double e, double width, double shape) {
  constexpr double special = 1e-12;  // nearer than this to 0 or 2 the limit is exact to rounding
  const double square = width * width;
  const double distance = std::abs(shape - 2.0);
  if (distance < special) return {e, 1.0, 0.0};
  const double logarithm = std::log1p(e / (square * distance));
  // ((1 + v)^(α/2) − 1) / α, which tends to ln(1 + v) / 2 for α → 0.
  const double growth = std::abs(shape) < special ? 0.5 * logarithm : std::expm1(0.5 * shape * logarithm) / shape;
  const double weight = std::exp((0.5 * shape - 1.0) * logarithm);
  const double second = 0.5 / square * std::exp((0.5 * shape - 2.0) * logarithm);
  return {2.0 * square * distance * growth, weight, shape < 2.0 ? -second : second};
}

RobustValue arctan(double e, double width, double) {
  const double square = width * width;
  const double ratio = e / square;
  const double weight = 1.0 / (1.0 + ratio * ratio);
  return {square * std::atan(ratio), weight, -2.0 * ratio * weight * weight / square};
}

constexpr RobustKernelType huberType{
    "Huber", huber,     "width in standard deviations: e, beyond it 2 width sqrt(e) - width^2", false, 0.0,
    false,   all<huber>};
constexpr RobustKernelType cauchyType{
    "Cauchy", cauchy, "width in standard deviations: width^2 ln(1 + e / width^2)", false, 0.0, false, all<cauchy>};
constexpr RobustKernelType tukeyType{
    "Tukey",   tukey, "width in standard deviations: width^2/3 (1 - (1 - e/width^2)^3), constant beyond it",
    false,     0.0,   false,
    all<tukey>};
constexpr RobustKernelType pseudoHuberType{
    "PseudoHuber", pseudoHuber,     "width in standard deviations: 2 width^2 (sqrt(1 + e/width^2) - 1)", false, 0.0,
    false,         all<pseudoHuber>};
constexpr RobustKernelType gemanMcClureType{"GemanMcClure",
                                            gemanMcClure,
                                            "width in squared standard deviations, as in g2o: width e / (width + e)",
                                            false,
                                            0.0,
                                            true,
                                            all<gemanMcClure>};
constexpr RobustKernelType welschType{
    "Welsch", welsch, "width in standard deviations: width^2 (1 - exp(-e/width^2))", false, 0.0, false, all<welsch>};
constexpr RobustKernelType fairType{
    "Fair", fair,     "width in standard deviations: 2 width^2 (sqrt(e)/width - ln(1 + sqrt(e)/width))", false, 0.0,
    false,  all<fair>};
constexpr RobustKernelType saturatedType{
    "Saturated", saturated, "width in standard deviations: min(e, width^2)", false, 0.0, false, all<saturated>};
constexpr RobustKernelType dcsType{
    "DCS",
    dcs,
    "dynamic covariance scaling, width in squared standard deviations: e, beyond it width (3e - width)/(width + e)",
    false,
    0.0,
    true,
    all<dcs>};
constexpr RobustKernelType barronType{"Barron",
                                      barron,
                                      "Barron's general kernel, width in standard deviations; shape 2 is none, 1 "
                                      "pseudo-Huber, 0 Cauchy, -2 Geman-McClure",
                                      true,
                                      1.0,
                                      false,
                                      all<barron>};
constexpr RobustKernelType arctanType{
    "Arctan", arctan, "width in standard deviations: width^2 arctan(e/width^2)", false, 0.0, false, all<arctan>};

}  // namespace

const RobustKernelType& huberKernel() { return huberType; }
const RobustKernelType& cauchyKernel() { return cauchyType; }
const RobustKernelType& tukeyKernel() { return tukeyType; }
const RobustKernelType& pseudoHuberKernel() { return pseudoHuberType; }
const RobustKernelType& gemanMcClureKernel() { return gemanMcClureType; }
const RobustKernelType& welschKernel() { return welschType; }
const RobustKernelType& fairKernel() { return fairType; }
const RobustKernelType& saturatedKernel() { return saturatedType; }
const RobustKernelType& dcsKernel() { return dcsType; }
const RobustKernelType& barronKernel() { return barronType; }
const RobustKernelType& arctanKernel() { return arctanType; }

void registerRobustKernels(Registry& registry) {
  for (const RobustKernelType* kernel :
       {&huberKernel(), &pseudoHuberKernel(), &cauchyKernel(), &gemanMcClureKernel(), &welschKernel(), &fairKernel(),
        &tukeyKernel(), &saturatedKernel(), &dcsKernel(), &barronKernel(), &arctanKernel()}) {
    registry.addRobustKernel(*kernel);
  }
}

}  // namespace quiver
