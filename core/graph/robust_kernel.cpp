#include <quiver/core/graph/robust_kernel.h>

#include <cmath>

#include <fmt/format.h>

#include <quiver/core/util/chi_squared.h>
#include <quiver/core/util/error.h>

namespace quiver {
RobustKernel::RobustKernel(const RobustKernelType& type, double width, double shape)
    : type_(&type), width_(width), shape_(shape) {
  if (!(width > 0.0) || !std::isfinite(width) || !std::isfinite(shape)) {
    throw GraphError(fmt::format("robust kernel {}: width {} and shape {}; the width must be positive, both finite",
                                 type.name, width, shape));
  }
  // Kernels compute with the width's square and with its inverse.
  if (!std::isnormal(width * width) || !std::isnormal(1.0 / (width * width))) {
    throw GraphError(
        fmt::format("robust kernel {}: the square of width {} is beyond the range of numbers; to "
                    "switch the kernel off, leave it out",
                    type.name, width));
  }
}

double RobustKernelType::widthOf(double probability, int dimension) const {
  const double squaredError = chiSquaredQuantile(probability, dimension);
  return squaredWidth ? squaredError : std::sqrt(squaredError);
}

}  // namespace quiver
