#include <quiver/core/algorithm/check_jacobians.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <quiver/core/problem/problem.h>

namespace quiver {
namespace {

/// A copy whose edges have the identity as information and no kernel, so that batches give errors as they are.
Graph plainCopy(const Graph& graph) {
  Graph copy(graph);
  std::vector<double> identity;
  copy.forEachEdge([&](Edge& edge) {
    const EdgeType& type = copy.typeOf(edge);
    const int n = type.errorDimension(edge);
    identity.assign(static_cast<std::size_t>(n * (n + 1) / 2), 0.0);
    for (int r = 0, k = 0; r < n; k += n - r, ++r) identity[static_cast<std::size_t>(k)] = 1.0;
    type.setInformation(edge, identity);
    edge.setRobustKernel(RobustKernel());
  });
  return copy;
}

constexpr double operations = 32.0;  // roundings that may add up in an error

/// Differences one edge of a batch.
class EdgeDifferences {
 public:
  EdgeDifferences(const Problem& problem, const EdgeBatch& batch, double step)
      : problem_(problem),
        batch_(batch),
        step_(step),
        buffer_(batch.largestShape(), true, 1),
        state_(problem.state()) {}

  std::int64_t jumps() const { return jumps_; }

  /// Replaces `worst` if an entry of this edge deviates more.
  void compare(std::int32_t edge, JacobianEntry& worst) {
    const EdgeShape shape = batch_.shape(edge);
    const std::span<const std::int32_t> list(&edge, 1);
    batch_.linearize(state_, list, buffer_.panel());
    std::vector<std::vector<double>> blocks;
    for (std::size_t role = 0; role < shape.columns.size(); ++role) {
      std::vector<double> block(static_cast<std::size_t>(shape.rows * shape.columns[role]));
      for (std::size_t k = 0; k < block.size(); ++k) block[k] = buffer_.panel().jacobian[role][k * Panel::lanes];
      blocks.push_back(std::move(block));
    }
    for (std::size_t role = 0; role < blocks.size(); ++role) {
      compareBlock(list, static_cast<int>(role), shape, blocks[role], worst);
    }
  }

 private:
  void compareBlock(std::span<const std::int32_t> edge, int role, const EdgeShape& shape,
                    const std::vector<double>& block, JacobianEntry& worst) {
    const int slot = batch_.slots(edge[0])[static_cast<std::size_t>(role)];
    const int columns = shape.columns[static_cast<std::size_t>(role)];
    double size = 1.0;
    for (const double entry : block) size = std::max(size, std::abs(entry));
    for (int c = 0; c < columns; ++c) {
      const Column column = differentiate(edge, slot, shape.rows, columns, c, size);
      if (column.slopes.empty()) {
        ++jumps_;
        continue;
      }
      for (int r = 0; r < shape.rows; ++r) {
        const auto i = static_cast<std::size_t>(r);
        const double computed = block[static_cast<std::size_t>(c * shape.rows + r)];
        const double expected = column.slopes[i];
        const double difference = std::abs(computed - expected);
        const double deviation = std::isfinite(difference) ? std::max(0.0, difference - column.rounding) / size
                                                           : std::numeric_limits<double>::infinity();
        if (!(deviation > worst.deviation) && !worst.vertices.empty()) continue;
        const auto ids = batch_.edge(edge[0]).vertexIds();
        worst = {{ids.begin(), ids.end()}, role, r, c, "", computed, expected, deviation};
        worst.direction = problem_.vertexType(slot).tangentNames(columns)[static_cast<std::size_t>(c)];
      }
    }
  }

  /// A column by differences, and what rounding makes of them. No slopes where the error jumps.
  struct Column {
    std::vector<double> slopes;
    double rounding = 0.0;
  };

  /// Differences over h and h/2, extrapolated. Where they disagree the error bends within the step, as it does along a
  /// coordinate whose own size is tiny: then with shorter steps, down to where they agree.
  /// `steepest` is the largest entry of the block, by which rounding of what moves is magnified.
  Column differentiate(std::span<const std::int32_t> edge, int slot, int rows, int columns, int direction,
                       double steepest) {
    constexpr double agreement = 1e-3;
    constexpr double negligible = 0.1;
    constexpr double spreads = 4.0;
    constexpr double shorter = 1.0 / 32.0;
    constexpr int tries = 8;
    Column first;
    double h = step_;
    for (int attempt = 0; attempt <= tries; ++attempt, h *= shorter) {
      const std::vector<double> wide = difference(edge, slot, rows, columns, direction, h);
      const std::vector<double> narrow = difference(edge, slot, rows, columns, direction, 0.5 * h);
      Column column{std::vector<double>(wide.size()), rounding_};
      // A third one, since two may agree by chance where the error oscillates within the step.
      const std::vector<double> third = difference(edge, slot, rows, columns, direction, 0.37 * h);
      double apart = 0.0, size = 0.0;
      for (std::size_t r = 0; r < wide.size(); ++r) {
        column.slopes[r] = (4.0 * narrow[r] - wide[r]) / 3.0;
        apart = std::max({apart, std::abs(narrow[r] - wide[r]), std::abs(narrow[r] - third[r])});
        size = std::max(size, std::abs(narrow[r]));
      }
      if (attempt > 0) {
        // A step shorter than usual is not much longer than the rounding of what moves, nor a steep error free of it.
        if (operations * stepRounding_ > negligible * h) break;
        column.rounding =
            std::max({column.rounding, operations * std::max(size, steepest) * stepRounding_ / h, spreads * apart});
      }
      // A jump of one or more: its slope over the step. Where the error is as steep as that, differences tell nothing.
      if (!(size <= 0.5 / h)) continue;
      if (apart <= agreement * size + rounding_) return column;
      if (first.slopes.empty()) first = std::move(column);
    }
    return first;
  }

  /// Of all estimates that an edge joins: what is added to which in its error, nobody knows.
  double largestValue(std::span<const std::int32_t> edge) const {
    double largest = 0.0;
    for (const std::int32_t slot : batch_.slots(edge[0])) {
      const double* const values = problem_.state().record(slot);
      for (int k = 0; k < problem_.layout().valueCount(slot); ++k) largest = std::max(largest, std::abs(values[k]));
    }
    return largest;
  }

  /// (e(x ⊞ h) − e(x ⊟ h)) / 2h along one direction of one vertex; leaves the state as it was.
  std::vector<double> difference(std::span<const std::int32_t> edge, int slot, int rows, int columns, int direction,
                                 double h) {
    const VertexType& type = problem_.vertexType(slot);
    const double* x = problem_.state().record(slot);
    std::vector<double> delta(static_cast<std::size_t>(columns), 0.0);
    const auto error = [&](double step) {
      delta[static_cast<std::size_t>(direction)] = step;
      type.retract(x, delta.data(), state_.record(slot), columns);
      batch_.evaluate(state_, edge, buffer_.panel());
      std::vector<double> e(static_cast<std::size_t>(rows));
      for (std::size_t r = 0; r < e.size(); ++r) e[r] = buffer_.panel().residual[r * Panel::lanes];
      return e;
    };
    std::vector<double> forward = error(h);
    const std::vector<double> backward = error(-h);
    double size = 0.0;
    const int count = problem_.layout().valueCount(slot);
    for (int k = 0; k < count; ++k) size = std::max(size, std::abs(x[k]));
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    stepRounding_ = epsilon * largestValue(edge);
    for (std::size_t r = 0; r < forward.size(); ++r) {
      size = std::max(size, std::abs(forward[r]));
      forward[r] = (forward[r] - backward[r]) / (2.0 * h);
    }
    std::copy_n(x, count, state_.record(slot));
    rounding_ = operations * epsilon * size / h;
    return forward;
  }

  const Problem& problem_;
  const EdgeBatch& batch_;
  double step_;
  PanelBuffer buffer_;
  State state_;
  double rounding_ = 0.0;
  double stepRounding_ = 0.0;  // of the estimate along the direction
  std::int64_t jumps_ = 0;
};

}  // namespace

JacobianReport checkJacobians(const Graph& graph, const JacobianCheckOptions& options) {
  Graph copy = plainCopy(graph);
  ProblemScope scope;
  scope.level = -1;
  const Problem problem(copy, scope);
  JacobianReport report;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    const std::int64_t count = batch.size();
    const std::int64_t compared =
        options.edgesPerType > 0 ? std::min<std::int64_t>(count, options.edgesPerType) : count;
    JacobianComparison comparison{problem.edgeType(b).tag(), problem.edgeType(b).form(), compared, 0, {}};
    EdgeDifferences differences(problem, batch, options.step);
    for (std::int64_t i = 0; i < compared; ++i) {
      differences.compare(static_cast<std::int32_t>(i * count / compared), comparison.worst);
    }
    comparison.jumps = differences.jumps();
    report.types.push_back(std::move(comparison));
  }
  return report;
}

double JacobianReport::worstDeviation() const {
  double worst = 0.0;
  for (const JacobianComparison& type : types) worst = std::max(worst, type.worst.deviation);
  return worst;
}

std::string JacobianReport::describe() const {
  static constexpr const char* forms[] = {"automatic", "analytic", "dual", "numeric"};
  std::string text;
  for (const JacobianComparison& type : types) {
    const JacobianEntry& e = type.worst;
    text += fmt::format(
        "{}: {} ({}), {} edges, worst deviation {:.3g} at error {} by {} of role {}: {:.9g} instead of {:.9g}, "
        "vertices "
        "{}\n",
        type.tag, forms[static_cast<int>(type.form.jacobians)], type.form.lanes ? "lanes" : "one at a time", type.edges,
        e.deviation, e.row, e.direction, e.role, e.computed, e.expected, fmt::join(e.vertices, " "));
    if (type.jumps > 0) text += fmt::format("  {} columns left out, where the error jumps\n", type.jumps);
  }
  return text;
}

}  // namespace quiver
