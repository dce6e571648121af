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
  /// Columns that were compared.
  std::int64_t compared() const { return compared_; }

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
  /// A column by differences, and how far each of its slopes may be off. No slopes where the error jumps.
  struct Column {
    std::vector<double> slopes;
    std::vector<double> doubts;
  };

  void compareBlock(std::span<const std::int32_t> edge, int role, const EdgeShape& shape,
                    const std::vector<double>& block, JacobianEntry& worst) {
    const int slot = batch_.slots(edge[0])[static_cast<std::size_t>(role)];
    const int columns = shape.columns[static_cast<std::size_t>(role)];
    const auto rows = static_cast<std::size_t>(shape.rows);
    // Rows have units of their own: each is measured by its largest entry.
    std::vector<Column> differences;
    std::vector<double> sizes(rows, 0.0);
    for (int c = 0; c < columns; ++c) {
      differences.push_back(differentiate(edge, slot, shape.rows, columns, c, block));
      for (std::size_t r = 0; r < rows; ++r) {
        const double slope = differences.back().slopes.empty() ? 0.0 : std::abs(differences.back().slopes[r]);
        sizes[r] = std::max({sizes[r], slope, std::abs(block[static_cast<std::size_t>(c) * rows + r])});
      }
    }
    constexpr double nothing = 1e-9;  // beside other rows
    const double least = nothing * *std::max_element(sizes.begin(), sizes.end());
    for (int c = 0; c < columns; ++c) {
      const Column& column = differences[static_cast<std::size_t>(c)];
      ++(column.slopes.empty() ? jumps_ : compared_);
      for (std::size_t r = 0; r < column.slopes.size(); ++r) {
        const double computed = block[static_cast<std::size_t>(c) * rows + r];
        const double apart = std::abs(computed - column.slopes[r]);
        const double beyond = std::isfinite(apart) ? apart - column.doubts[r] : std::numeric_limits<double>::infinity();
        const double deviation = beyond > 0.0 ? beyond / std::max(sizes[r], least) : 0.0;
        if (!(deviation > worst.deviation) && !worst.vertices.empty()) continue;
        const auto ids = batch_.edge(edge[0]).vertexIds();
        worst = {{ids.begin(), ids.end()}, role, static_cast<int>(r), c, "", computed, column.slopes[r], deviation};
        worst.direction = problem_.vertexType(slot).tangentNames(columns)[static_cast<std::size_t>(c)];
      }
    }
  }

  /// Differences over h and h/2, extrapolated, and over 0.37 h, since two may agree by chance where the error
  /// oscillates within the step. Where they disagree the error bends within the step, as it does along a coordinate
  /// whose own size is tiny, or jumps: then with shorter steps, down to where they agree. `block` tells how rounding of
  /// what moves is magnified.
  Column differentiate(std::span<const std::int32_t> edge, int slot, int rows, int columns, int direction,
                       const std::vector<double>& block) {
    constexpr double negligible = 0.1;
    constexpr double shorter = 1.0 / 32.0;
    constexpr int tries = 8;
    const double coarseness = operations * std::numeric_limits<double>::epsilon();
    const double largest = largestValue(edge);
    double h = firstStep(slot, direction, columns);
    for (int attempt = 0; attempt <= tries; ++attempt, h *= shorter) {
      // A step shorter than usual is not much longer than the rounding of what moves.
      if (attempt > 0 && coarseness * largest > negligible * h) break;
      const Difference wide = difference(edge, slot, rows, columns, direction, h);
      const Difference narrow = difference(edge, slot, rows, columns, direction, 0.5 * h);
      const Difference third = difference(edge, slot, rows, columns, direction, 0.37 * h);
      bool agree = true;
      Column column;
      for (std::size_t r = 0; r < wide.slopes.size(); ++r) {
        double steepest = std::abs(narrow.slopes[r]);
        for (std::size_t k = r; k < block.size(); k += wide.slopes.size())
          steepest = std::max(steepest, std::abs(block[k]));
        double doubt = coarseness * (wide.sizes[r] + steepest * largest) / h;
        agree = agree && agrees(wide.slopes[r], narrow.slopes[r], third.slopes[r], doubt);
        column.slopes.push_back((4.0 * narrow.slopes[r] - wide.slopes[r]) / 3.0);
        column.doubts.push_back(doubt);
      }
      if (agree) return column;
    }
    return {};
  }

  /// Whether three slopes of a row are one; their spread adds to its doubt then.
  static bool agrees(double wide, double narrow, double third, double& doubt) {
    constexpr double agreement = 1e-3;
    constexpr double spreads = 4.0;
    const double apart = std::max(std::abs(narrow - wide), std::abs(narrow - third));
    if (!(apart <= agreement * std::abs(narrow) + doubt)) return false;
    doubt += spreads * apart;
    return true;
  }

  /// Far from the origin numbers are coarser, and errors as smooth as anywhere. Never a step that vanishes in them; a
  /// power of two, which rounds as little as can be when it is added.
  double firstStep(int slot, int direction, int columns) const {
    constexpr double most = 1e3;
    const int count = problem_.layout().valueCount(slot);
    const double* const values = problem_.state().record(slot);
    double size = 1.0;
    for (int k = 0; k < count; ++k) {
      if (count != columns || k == direction) size = std::max(size, std::abs(values[k]));
    }
    constexpr double coarse = 64.0 * operations * std::numeric_limits<double>::epsilon();
    const double step = std::max(step_ * std::min(most, std::cbrt(size)), coarse * size);
    return std::isfinite(step) ? std::ldexp(1.0, std::ilogb(step)) : step_;
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

  /// Slopes of the rows of an error, and how large the rows were.
  struct Difference {
    std::vector<double> slopes;
    std::vector<double> sizes;
  };

  /// (e(x ⊞ h) − e(x ⊟ h)) / 2h along one direction of one vertex; leaves the state as it was.
  Difference difference(std::span<const std::int32_t> edge, int slot, int rows, int columns, int direction, double h) {
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
    const std::vector<double> forward = error(h);
    const std::vector<double> backward = error(-h);
    std::copy_n(x, problem_.layout().valueCount(slot), state_.record(slot));
    Difference result;
    for (std::size_t r = 0; r < forward.size(); ++r) {
      result.slopes.push_back((forward[r] - backward[r]) / (2.0 * h));
      result.sizes.push_back(std::max(std::abs(forward[r]), std::abs(backward[r])));
    }
    return result;
  }

  const Problem& problem_;
  const EdgeBatch& batch_;
  double step_;
  PanelBuffer buffer_;
  State state_;
  std::int64_t jumps_ = 0;
  std::int64_t compared_ = 0;
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
    if (differences.compared() == 0 && differences.jumps() > 0)
      comparison.worst.deviation = std::numeric_limits<double>::infinity();
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
    if (type.jumps > 0 && std::isinf(e.deviation) && e.vertices.empty()) {
      text += fmt::format(
          "{}: {} edges, nothing to compare: the error jumps within every step, or is no function of its arguments "
          "alone\n",
          type.tag, type.edges);
      continue;
    }
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
