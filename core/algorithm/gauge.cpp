#include <quiver/core/algorithm/gauge.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>

namespace quiver {
namespace {

class DisjointSets {
 public:
  explicit DisjointSets(int count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int i) {
    while (at(i) != i) {
      at(i) = at(at(i));
      i = at(i);
    }
    return i;
  }
  void unite(int a, int b) {
    a = find(a);
    b = find(b);
    if (a != b) at(std::max(a, b)) = std::min(a, b);
  }

 private:
  int& at(int i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<int> parent_;
};

using Generators = Eigen::Matrix<double, gaugeDirections, gaugeDirections>;

/// Σ (J G)ᵀ(J G) over the edges of a component, and Σ over edges and roles of ‖J_role G‖² per generator, the scale of
/// the sum; and GᵀG.
struct Products {
  Generators square = Generators::Zero();
  Generators gram = Generators::Zero();
  Eigen::Matrix<double, gaugeDirections, 1> scale = Eigen::Matrix<double, gaugeDirections, 1>::Zero();
};

std::vector<ComponentGauge> components(const Problem& problem, std::vector<int>& componentOf) {
  DisjointSets sets(problem.variables());
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    for (int i = 0; i < batch.size(); ++i) {
      int first = -1;
      for (const std::int32_t slot : batch.slots(i)) {
        const int variable = problem.variableOfSlot(slot);
        if (variable < 0) continue;
        if (first < 0) {
          first = variable;
        } else {
          sets.unite(first, variable);
        }
      }
    }
  }
  std::vector<ComponentGauge> result;
  componentOf.assign(static_cast<std::size_t>(problem.variables()), -1);
  for (int v = 0; v < problem.variables(); ++v) {
    const int root = sets.find(v);  // the smallest variable of its component, so it is numbered first
    if (root == v) {
      componentOf[static_cast<std::size_t>(v)] = static_cast<int>(result.size());
      result.emplace_back();
    }
    componentOf[static_cast<std::size_t>(v)] = componentOf[static_cast<std::size_t>(root)];
    result[static_cast<std::size_t>(componentOf[static_cast<std::size_t>(v)])].variables.push_back(v);
  }
  return result;
}

int findAnchor(const Problem& problem, const std::vector<int>& variables) {
  int anchor = -1;
  for (const int v : variables) {
    if (anchor >= 0) {
      if (problem.dimension(v) < problem.dimension(anchor)) continue;
      const bool lower =
          problem.vertex(problem.slotOfVariable(v)).id() < problem.vertex(problem.slotOfVariable(anchor)).id();
      if (problem.dimension(v) == problem.dimension(anchor) && !lower) continue;
    }
    anchor = v;
  }
  return anchor;
}

/// Generators of every slot, row-major dimension × gaugeDirections; empty for fixed slots and for types that supply
/// none.
std::vector<double> slotGenerators(const Problem& problem, std::vector<std::int64_t>& begin,
                                   const std::vector<int>& componentOf, std::vector<ComponentGauge>& gauges) {
  std::vector<double> all;
  begin.assign(static_cast<std::size_t>(problem.slots()), -1);
  for (int slot = 0; slot < problem.slots(); ++slot) {
    const int variable = problem.variableOfSlot(slot);
    if (variable < 0) continue;
    const int dimension = problem.dimension(variable);
    const auto at = static_cast<std::int64_t>(all.size());
    all.resize(all.size() + static_cast<std::size_t>(dimension * gaugeDirections), 0.0);
    if (!problem.vertexType(slot).gaugeGenerators(problem.state().record(slot), all.data() + at)) {
      gauges[static_cast<std::size_t>(componentOf[static_cast<std::size_t>(variable)])].tested = false;
      all.resize(static_cast<std::size_t>(at));
      continue;
    }
    const std::uint64_t held = problem.heldDirections(variable);
    for (int r = 0; held != 0 && r < dimension && r < 64; ++r) {
      if (held >> r & 1) std::fill_n(all.data() + at + r * gaugeDirections, static_cast<int>(gaugeDirections), 0.0);
    }
    begin[static_cast<std::size_t>(slot)] = at;
  }
  return all;
}

/// Adds one edge's J G to its component. `scratch` is memory for twice rows × padded numbers; rows of eight, of which
/// seven count, so that the innermost loops run over whole vectors.
void addEdge(const Problem& problem, const EdgeBatch& batch, int edge, int place, const EdgeShape& shape,
             const Panel& panel, const std::vector<std::int64_t>& begin, const std::vector<double>& generators,
             const std::vector<int>& componentOf, std::vector<double>& scratch, std::vector<Products>& products) {
  constexpr int padded = 8;
  static_assert(gaugeDirections <= padded);
  const auto slots = batch.slots(edge);
  const auto numbers = static_cast<std::size_t>(shape.rows * padded);
  scratch.assign(2 * numbers, 0.0);
  double* moved = scratch.data();
  double* part = moved + numbers;
  Products* target = nullptr;
  for (std::size_t role = 0; role < slots.size(); ++role) {
    const std::int64_t at = begin[static_cast<std::size_t>(slots[role])];
    if (at < 0) continue;
    target =
        &products[static_cast<std::size_t>(componentOf[static_cast<std::size_t>(problem.variableOfSlot(slots[role]))])];
    const int columns = shape.columns[role];
    const double* J = panel.jacobian[role] + std::int64_t{place / Panel::lanes} * columns * shape.rows * Panel::lanes +
                      place % Panel::lanes;
    std::fill_n(part, numbers, 0.0);
    for (int c = 0; c < columns; ++c) {
      double g[padded] = {};
      std::copy_n(generators.data() + at + c * gaugeDirections, static_cast<int>(gaugeDirections), g);
      for (int r = 0; r < shape.rows; ++r) {
        const double j = J[(c * shape.rows + r) * Panel::lanes];
        for (int k = 0; k < padded; ++k) part[r * padded + k] += j * g[k];
      }
    }
    for (int r = 0; r < shape.rows; ++r) {
      for (int k = 0; k < gaugeDirections; ++k) {
        const double value = part[r * padded + k];
        moved[r * padded + k] += value;
        target->scale[k] += value * value;
      }
    }
  }
  if (!target) return;
  for (int r = 0; r < shape.rows; ++r) {
    const double* row = moved + r * padded;
    for (int a = 0; a < gaugeDirections; ++a) {
      for (int b = 0; b < gaugeDirections; ++b) target->square(b, a) += row[a] * row[b];
    }
  }
}

/// Adds one vertex's GᵀG to its component.
void addVertex(const double* generators, int dimension, Products& products) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, gaugeDirections, Eigen::RowMajor>;
  const Eigen::Map<const Rows> G(generators, dimension, gaugeDirections);
  products.gram += G.transpose() * G;
}

/// Eigenvalues below `zero` of the rows and columns `live` of a matrix, scaled by the roots of `scale`.
int nullity(const Generators& matrix, const Eigen::Matrix<double, gaugeDirections, 1>& scale,
            const std::vector<int>& live, double zero) {
  Eigen::MatrixXd scaled(live.size(), live.size());
  for (std::size_t a = 0; a < live.size(); ++a) {
    for (std::size_t b = 0; b < live.size(); ++b) {
      scaled(static_cast<int>(a), static_cast<int>(b)) =
          matrix(live[a], live[b]) / std::sqrt(scale[live[a]] * scale[live[b]]);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled, Eigen::EigenvaluesOnly);
  return static_cast<int>((eigen.eigenvalues().array() < zero).count());
}

/// The combinations of generators that change no error, less those that move nothing at all: among the generators of a
/// single vertex, say, there are more than it has directions.
int freeDirections(const Products& products) {
  // Generators that move nothing (a roll in the plane) are left out; the others are scaled to compare with each other.
  std::vector<int> live;
  for (int k = 0; k < gaugeDirections; ++k) {
    if (products.scale[k] > 0.0) live.push_back(k);
  }
  if (live.empty()) return 0;
  // (J G)ᵀ(J G) cancels to ε²; genuine priors of weight 1e-14 of the sum are priors no more.
  const int unnoticed = nullity(products.square, products.scale, live, 1e-14);
  const int motionless = nullity(products.gram, products.gram.diagonal(), live, 1e-13);
  return std::max(0, unnoticed - motionless);
}

}  // namespace

std::vector<ComponentGauge> findGauges(const Problem& problem) {
  std::vector<int> componentOf;
  std::vector<ComponentGauge> gauges = components(problem, componentOf);
  std::vector<std::int64_t> begin;
  const std::vector<double> generators = slotGenerators(problem, begin, componentOf, gauges);
  std::vector<Products> products(gauges.size());
  for (int variable = 0; variable < problem.variables(); ++variable) {
    const std::int64_t at = begin[static_cast<std::size_t>(problem.slotOfVariable(variable))];
    if (at < 0) continue;
    addVertex(generators.data() + at, problem.dimension(variable),
              products[static_cast<std::size_t>(componentOf[static_cast<std::size_t>(variable)])]);
  }
  std::vector<std::int32_t> ids(Panel::capacity);
  std::vector<double> scratch;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    PanelBuffer buffer(batch.largestShape());
    const int step = batch.uniform() ? Panel::capacity : 1;
    for (int first = 0; first < batch.size(); first += step) {
      const int count = std::min(step, batch.size() - first);
      std::iota(ids.begin(), ids.end(), first);
      batch.linearize(problem.state(), {ids.data(), static_cast<std::size_t>(count)}, buffer.panel());
      const EdgeShape shape = batch.shape(first);
      for (int i = 0; i < count; ++i)
        addEdge(problem, batch, first + i, i, shape, buffer.panel(), begin, generators, componentOf, scratch, products);
    }
  }
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    gauges[i].anchor = findAnchor(problem, gauges[i].variables);
    gauges[i].free = gauges[i].tested ? freeDirections(products[i]) : 0;
  }
  return gauges;
}

}  // namespace quiver
