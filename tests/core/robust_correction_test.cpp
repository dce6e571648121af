#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/problem/apply_kernels.h>
#include <quiver/core/util/error.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;

/// A number with two infinitesimals and their product: f(x) carries ∂f/∂x_i, ∂f/∂x_j and ∂²f/∂x_i∂x_j.
struct HyperDual {
  double value = 0.0, i = 0.0, j = 0.0, ij = 0.0;

  HyperDual() = default;
  HyperDual(double constant) : value(constant) {}
  HyperDual(double a, double b, double c, double d) : value(a), i(b), j(c), ij(d) {}
  /// f(x) from f, f' and f'' at x's value.
  HyperDual chain(double f, double first, double second) const {
    return {f, first * i, first * j, first * ij + second * i * j};
  }
};
HyperDual operator+(HyperDual a, HyperDual b) { return {a.value + b.value, a.i + b.i, a.j + b.j, a.ij + b.ij}; }
HyperDual operator-(HyperDual a, HyperDual b) { return {a.value - b.value, a.i - b.i, a.j - b.j, a.ij - b.ij}; }
HyperDual operator*(HyperDual a, HyperDual b) {
  return {a.value * b.value, a.i * b.value + a.value * b.i, a.j * b.value + a.value * b.j,
          a.ij * b.value + a.i * b.j + a.j * b.i + a.value * b.ij};
}
HyperDual power(HyperDual x, double p) {
  return x.chain(std::pow(x.value, p), p * std::pow(x.value, p - 1.0), p * (p - 1.0) * std::pow(x.value, p - 2.0));
}
HyperDual operator/(HyperDual a, HyperDual b) { return a * power(b, -1.0); }
HyperDual logarithm(HyperDual x) { return x.chain(std::log(x.value), 1.0 / x.value, -1.0 / (x.value * x.value)); }
HyperDual exponential(HyperDual x) { return x.chain(std::exp(x.value), std::exp(x.value), std::exp(x.value)); }
HyperDual arcTangent(HyperDual x) {
  const double q = 1.0 + x.value * x.value;
  return x.chain(std::atan(x.value), 1.0 / q, -2.0 * x.value / (q * q));
}

/// ρ written anew from the published formulas, for width w.
struct Kernel {
  RobustKernel kernel;
  std::function<HyperDual(HyperDual)> rho;
};

std::vector<Kernel> kernels() {
  constexpr double w = 1.5;
  constexpr double w2 = w * w;
  const auto barron = [](double a) {
    return [a](HyperDual e) {
      const double b = std::abs(a - 2.0);
      return 2.0 * w2 * b / a * (power(1.0 + e / (w2 * b), 0.5 * a) - 1.0);
    };
  };
  return {
      {RobustKernelHuber(w), [](HyperDual e) { return e.value <= w2 ? e : 2.0 * w * power(e, 0.5) - w2; }},
      {RobustKernelPseudoHuber(w), [](HyperDual e) { return 2.0 * w2 * (power(1.0 + e / w2, 0.5) - 1.0); }},
      {RobustKernelCauchy(w), [](HyperDual e) { return w2 * logarithm(1.0 + e / w2); }},
      {RobustKernelGemanMcClure(w), [](HyperDual e) { return w * e / (w + e); }},
      {RobustKernelWelsch(w), [](HyperDual e) { return w2 * (1.0 - exponential(0.0 - e / w2)); }},
      {RobustKernelFair(w),
       [](HyperDual e) {
         const HyperDual root = power(e, 0.5) / w;
         return 2.0 * w2 * (root - logarithm(1.0 + root));
       }},
      {RobustKernelTukey(w),
       [](HyperDual e) { return e.value <= w2 ? w2 / 3.0 * (1.0 - power(1.0 - e / w2, 3.0)) : HyperDual(w2 / 3.0); }},
      {RobustKernelSaturated(w), [](HyperDual e) { return e.value <= w2 ? e : HyperDual(w2); }},
      {RobustKernelDCS(w), [](HyperDual e) { return e.value <= w ? e : w * (3.0 * e - w) / (w + e); }},
      {RobustKernelBarron(w, -1.0), barron(-1.0)},
      {RobustKernelBarron(w, 1.2), barron(1.2)},
      {RobustKernelArctan(w), [](HyperDual e) { return w2 * arcTangent(e / w2); }},
  };
}

constexpr int rows = 3;
constexpr int columns[] = {2, 3};
constexpr int unknowns = 5;
constexpr int count = 13;  // two groups of lanes, the second not full

struct Linear {
  Eigen::Matrix<double, rows, 1> r;
  Eigen::Matrix<double, rows, unknowns> J;
};

/// Residuals from a tenth to ten times a typical kernel's width.
std::vector<Linear> randomEdges() {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Linear> edges(count);
  for (int i = 0; i < count; ++i) {
    Linear& edge = edges[static_cast<std::size_t>(i)];
    for (double& value : edge.J.reshaped()) value = normal(random);
    for (double& value : edge.r.reshaped()) value = normal(random);
    edge.r *= std::pow(10.0, -1.0 + 2.0 * i / (count - 1)) / edge.r.norm();
  }
  return edges;
}

/// The panel of those edges, corrected.
std::vector<Linear> corrected(const std::vector<Linear>& edges, const RobustKernel& kernel,
                              RobustCorrection correction) {
  PanelBuffer buffer({rows, {columns[0], columns[1]}});
  const Panel& panel = buffer.panel();
  std::vector<std::int32_t> ids;
  const auto place = [](int i, int entries, int k) { return (i / 8 * entries + k) * 8 + i % 8; };
  for (int i = 0; i < count; ++i) {
    const Linear& edge = edges[static_cast<std::size_t>(i)];
    ids.push_back(i);
    panel.squaredError[i] = edge.r.squaredNorm();
    for (int r = 0; r < rows; ++r) panel.residual[place(i, rows, r)] = edge.r[r];
    for (int role = 0, first = 0; role < 2; first += columns[role++]) {
      for (int c = 0; c < columns[role]; ++c) {
        for (int r = 0; r < rows; ++r)
          panel.jacobian[role][place(i, rows * columns[role], c * rows + r)] = edge.J(r, first + c);
      }
    }
  }
  detail::BatchKernels kernels;
  kernels.collect(count, [&](int) { return kernel; });
  detail::applyKernels(panel, kernels, ids, rows, columns, correction);
  std::vector<Linear> result(count);
  for (int i = 0; i < count; ++i) {
    Linear& edge = result[static_cast<std::size_t>(i)];
    for (int r = 0; r < rows; ++r) edge.r[r] = panel.residual[place(i, rows, r)];
    for (int role = 0, first = 0; role < 2; first += columns[role++]) {
      for (int c = 0; c < columns[role]; ++c) {
        for (int r = 0; r < rows; ++r)
          edge.J(r, first + c) = panel.jacobian[role][place(i, rows * columns[role], c * rows + r)];
      }
    }
  }
  return result;
}

struct Derivatives {
  Eigen::Matrix<double, unknowns, 1> gradient;
  Eigen::Matrix<double, unknowns, unknowns> hessian;
};

/// Of ½ρ(‖r + Jx‖²) at x = 0: the residual is linear, so there is no curvature of its own.
Derivatives differentiated(const Linear& edge, const Kernel& kernel) {
  Derivatives result;
  for (int i = 0; i < unknowns; ++i) {
    for (int j = 0; j < unknowns; ++j) {
      HyperDual square;
      for (int r = 0; r < rows; ++r) {
        const HyperDual residual(edge.r[r], edge.J(r, i), edge.J(r, j), 0.0);
        square = square + residual * residual;
      }
      const HyperDual half = 0.5 * kernel.rho(square);
      result.gradient[i] = half.i;
      result.hessian(i, j) = half.ij;
    }
  }
  return result;
}

/// 1 + 2eρ''/ρ' below which the second-order correction falls back to the first, with room for rounding.
constexpr double safe = 0.0101;

TEST(RobustCorrection, SecondOrderIsTheHessianWithoutTheResidualsCurvature) {
  const std::vector<Linear> edges = randomEdges();
  for (const Kernel& kernel : kernels()) {
    const std::vector<Linear> out = corrected(edges, kernel.kernel, RobustCorrection::second);
    int exact = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Derivatives expected = differentiated(edges[i], kernel);
      const double e = edges[i].r.squaredNorm();
      const RobustValue value = kernel.kernel.evaluate(e);
      const double scale = 1e-12 * (1.0 + edges[i].J.squaredNorm()) * (1.0 + std::sqrt(e));
      const auto H = (out[i].J.transpose() * out[i].J).eval();
      EXPECT_LT((out[i].J.transpose() * out[i].r - expected.gradient).norm(), 100.0 * scale)
          << kernel.kernel.name() << " at " << e;
      if (value.weight > 0.0 && 1.0 + 2.0 * e * value.second / value.weight < safe) {
        const auto first = (value.weight * edges[i].J.transpose() * edges[i].J).eval();
        EXPECT_LT((H - first).norm(), scale) << kernel.kernel.name() << " at " << e;
        continue;
      }
      EXPECT_LT((H - expected.hessian).norm(), scale) << kernel.kernel.name() << " at " << e;
      ++exact;
    }
    EXPECT_GE(exact, 4) << kernel.kernel.name();
  }
}

TEST(RobustCorrection, FirstOrderHasTheSameGradientAndTheWeightedHessian) {
  const std::vector<Linear> edges = randomEdges();
  for (const Kernel& kernel : kernels()) {
    const std::vector<Linear> out = corrected(edges, kernel.kernel, RobustCorrection::first);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const double weight = kernel.kernel.evaluate(edges[i].r.squaredNorm()).weight;
      const double scale = 1e-12 * (1.0 + edges[i].J.squaredNorm()) * (1.0 + edges[i].r.norm());
      EXPECT_LT((out[i].J.transpose() * out[i].J - weight * edges[i].J.transpose() * edges[i].J).norm(), scale);
      EXPECT_LT((out[i].J.transpose() * out[i].r - differentiated(edges[i], kernel).gradient).norm(), scale);
    }
  }
}

/// A ring in which every seventh range is a metre off.
Graph ringWithOutliers(const RobustKernel& kernel) {
  Graph graph = ringGraph<EdgeRangeDual>(30, 6);
  int next = 0;
  graph.forEachEdge([&](Edge& edge) {
    edge.setRobustKernel(kernel);
    if (edge.vertexId(1) < 1000 || ++next % 7 != 0) return;
    auto& range = static_cast<EdgeRangeDual&>(edge);
    range.setMeasurement(range.measurement() + 1.0);
  });
  return graph;
}

TEST(RobustCorrection, BothReachOneOptimumTheSecondFasterNearIt) {
  for (const RobustKernel& kernel :
       {RobustKernel(RobustKernelCauchy(3.0)), RobustKernel(RobustKernelPseudoHuber(1.0))}) {
    Graph graph = ringWithOutliers(kernel);
    Graph copy(graph);
    const Summary first = optimize(graph, {.algorithm = "lm"});
    const Summary second = optimize(copy, {.algorithm = "lm", .robustCorrection = RobustCorrection::second});
    EXPECT_TRUE(first.converged()) << first.reason;
    EXPECT_TRUE(second.converged()) << second.reason;
    EXPECT_NEAR(second.finalCost, first.finalCost, 1e-8 * first.finalCost) << kernel.name();
    // Near the optimum reweighting converges linearly, the full curvature faster.
    for (int id = 1; id < 30; ++id) {
      auto& pose = graph.vertex<VertexSE2>(id);
      pose.setEstimate(pose.estimate().retract(Vector<double, 3>(1e-3 * std::sin(7.0 * id), 1e-3 * std::cos(id), 0.0)));
    }
    copy = Graph(graph);
    const auto steps = optimize(graph, {.algorithm = "gn"}).iterations.size();
    EXPECT_LT(optimize(copy, {.algorithm = "gn", .robustCorrection = RobustCorrection::second}).iterations.size(),
              steps)
        << kernel.name();
  }
}

TEST(RobustKernel, WidthFromAProbability) {
  // 95 % of a three-dimensional residual's squared errors stay below 7.8147.
  EXPECT_NEAR(huberKernel().widthOf(0.95, 3), std::sqrt(7.814727903251179), 1e-12);
  EXPECT_NEAR(gemanMcClureKernel().widthOf(0.95, 3), 7.814727903251179, 1e-12);
  EXPECT_NEAR(dcsKernel().widthOf(0.95, 3), 7.814727903251179, 1e-12);
  EXPECT_THROW((void)huberKernel().widthOf(1.0, 3), GraphError);
  EXPECT_THROW((void)huberKernel().widthOf(0.5, 0), GraphError);
}

}  // namespace
}  // namespace quiver
