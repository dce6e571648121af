#include <quiver/core/algorithm/gauge.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <type_traits>

#include <quiver/core/algorithm/gauge_holds.h>
#include <quiver/core/algorithm/gauge_products.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

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

using Generators = detail::GaugeProducts;
using Combinations = detail::GaugeCombinations;
using Products = detail::ComponentProducts;

constexpr int padded = detail::gaugeRow;
/// (J G)ᵀ(J G) cancels to ε²; genuine priors of weight 1e-14 of the sum are priors no more.
constexpr double unnoticed = 1e-14;
/// What some edges notice so clearly the others cannot hide.
constexpr double clearlyNoticed = 1e-4;

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

/// Generators of every slot, dimension rows of eight; none for fixed slots and for types that supply none.
std::vector<double> slotGenerators(const Problem& problem, std::vector<std::int64_t>& begin,
                                   const std::vector<int>& componentOf, std::vector<ComponentGauge>& gauges) {
  std::vector<double> all;
  std::vector<double> own;
  begin.assign(static_cast<std::size_t>(problem.slots()), -1);
  for (int slot = 0; slot < problem.slots(); ++slot) {
    const int variable = problem.variableOfSlot(slot);
    if (variable < 0) continue;
    const int dimension = problem.dimension(variable);
    const auto at = static_cast<std::int64_t>(all.size());
    own.assign(static_cast<std::size_t>(dimension * gaugeDirections), 0.0);
    if (!problem.vertexType(slot).gaugeGenerators(problem.state().record(slot), own.data())) {
      gauges[static_cast<std::size_t>(componentOf[static_cast<std::size_t>(variable)])].tested = false;
      continue;
    }
    all.resize(all.size() + static_cast<std::size_t>(dimension * padded), 0.0);
    const std::uint64_t held = problem.heldDirections(variable);
    for (int r = 0; r < dimension; ++r) {
      if (r < 64 && (held >> r & 1) != 0) continue;
      std::copy_n(own.data() + r * gaugeDirections, static_cast<int>(gaugeDirections), all.data() + at + r * padded);
    }
    begin[static_cast<std::size_t>(slot)] = at;
  }
  return all;
}

/// A basis of the same columns in which each has a row of its own where it is 1 and the others are 0: shifts and turns
/// come apart as far as they can, whatever the units of length.
Eigen::MatrixXd separated(Eigen::MatrixXd basis) {
  constexpr double rounding = 1e-10;
  std::vector<char> used(static_cast<std::size_t>(basis.rows()), 0);
  for (Eigen::Index s = 0; s < basis.cols(); ++s) {
    Eigen::Index row = 0, column = s;
    double largest = 0.0;
    for (Eigen::Index c = s; c < basis.cols(); ++c) {
      for (Eigen::Index r = 0; r < basis.rows(); ++r) {
        if (used[static_cast<std::size_t>(r)] || !(std::abs(basis(r, c)) > largest)) continue;
        largest = std::abs(basis(r, c));
        row = r;
        column = c;
      }
    }
    if (largest == 0.0) break;
    used[static_cast<std::size_t>(row)] = 1;
    basis.col(s).swap(basis.col(column));
    basis.col(s) /= basis(row, s);
    for (Eigen::Index c = 0; c < basis.cols(); ++c) {
      if (c != s) basis.col(c) -= basis(row, c) * basis.col(s);
    }
  }
  return basis.unaryExpr([](double x) { return std::abs(x) > rounding ? x : 0.0; });
}

/// Combinations of generators, a column each: eigenvectors with eigenvalues below `zero` of the rows and columns `live`
/// of a matrix that is scaled by the roots of `scale`.
Combinations nullSpace(const Generators& matrix, std::span<const double> scale, const std::vector<int>& live,
                       double zero) {
  Eigen::MatrixXd scaled(live.size(), live.size());
  for (std::size_t a = 0; a < live.size(); ++a) {
    for (std::size_t b = 0; b < live.size(); ++b) {
      const double product = scale[static_cast<std::size_t>(live[a])] * scale[static_cast<std::size_t>(live[b])];
      scaled(static_cast<int>(a), static_cast<int>(b)) = matrix(live[a], live[b]) / std::sqrt(product);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const auto count = (eigen.eigenvalues().array() < zero).count();
  Combinations result = Combinations::Zero(gaugeDirections, count);
  const Eigen::MatrixXd basis = separated(eigen.eigenvectors().leftCols(count));
  for (std::size_t a = 0; a < live.size(); ++a)
    result.row(live[a]) = basis.row(static_cast<int>(a)) / std::sqrt(scale[static_cast<std::size_t>(live[a])]);
  return result;
}

/// The combinations of generators that change errors by less than `noticed` of their scale, and their number less those
/// that move nothing at all: among the generators of a single vertex, say, there are more than it has directions.
int freeDirections(const Products& products, double noticed, Combinations& unseen) {
  // Generators that move nothing (a roll in the plane) are left out; the others are scaled to compare with each other.
  std::vector<int> live;
  std::array<double, padded> scale = products.scale;
  // Of what no edge has any weight in, nothing can be compared; and where that is so of all, it is no gauge: the
  // diagnosis names the vertices.
  if (std::all_of(scale.begin(), scale.end(), [](double own) { return own == 0.0; })) return 0;
  for (int k = 0; k < gaugeDirections; ++k) {
    if (!(products.gram(k, k) > 0.0)) continue;
    live.push_back(k);
    double& own = scale[static_cast<std::size_t>(k)];
    if (own == 0.0) own = 1.0;
  }
  if (live.empty()) return 0;
  const Eigen::Map<const Generators, 0, Eigen::OuterStride<padded>> square(products.square.data());
  const Eigen::Matrix<double, gaugeDirections, 1> lengths = products.gram.diagonal();
  unseen = nullSpace(square, scale, live, noticed);
  const auto motionless = nullSpace(products.gram, {lengths.data(), gaugeDirections}, live, 1e-13).cols();
  return std::max(0, static_cast<int>(unseen.cols() - motionless));
}

/// Whether the first edges of a problem of one variable hold all its directions beyond doubt, as a few pixels of known
/// points do for the pose of one camera: the pivots of their JᵀJ, scaled to a unit diagonal, are clearly positive.
bool clearlyHeld(const Problem& problem) {
  constexpr int lanes = Panel::lanes, few = 2 * lanes, mostDirections = 9;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, mostDirections, mostDirections>;
  const EdgeBatch& batch = problem.batch(0);
  const int dimension = problem.dimension(0);
  if (!batch.uniform() || dimension > mostDirections) return false;
  const EdgeShape shape = batch.largestShape();
  const int count = std::min(batch.size(), few);
  PanelBuffer buffer(shape, true, few);
  const Panel& panel = buffer.panel();
  std::int32_t ids[few];
  std::iota(ids, ids + count, 0);
  batch.linearize(problem.state(), {ids, static_cast<std::size_t>(count)}, panel);
  Square square = Square::Zero(dimension, dimension);
  for (std::size_t role = 0; role < shape.columns.size(); ++role) {
    double joins[few] = {};
    for (int i = 0; i < count; ++i) joins[i] = batch.slots(i)[role] == problem.slotOfVariable(0) ? 1.0 : 0.0;
    if (std::all_of(joins, joins + count, [](double one) { return one == 0.0; })) continue;
    const auto numbers = [&](int group, int r, int column) {
      return panel.jacobian[role] + ((group * dimension + column) * shape.rows + r) * lanes;
    };
    for (int a = 0; a < dimension; ++a) {
      for (int b = 0; b <= a; ++b) {
        double sums[lanes] = {};
        for (int group = 0; group * lanes < count; ++group) {
          for (int r = 0; r < shape.rows; ++r) {
            const double *const first = numbers(group, r, a), *const second = numbers(group, r, b);
            for (int k = 0; k < lanes; ++k) sums[k] += joins[group * lanes + k] * first[k] * second[k];
          }
        }
        square(a, b) += std::accumulate(sums, sums + lanes, 0.0);
      }
    }
  }
  // Not a number would pass for a pivot.
  if (!square.allFinite() || !(square.diagonal().minCoeff() > 0.0)) return false;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, mostDirections, 1> scale =
      square.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Square> factor(scale.asDiagonal() * square * scale.asDiagonal());
  return factor.info() == Eigen::Success && factor.matrixLLT().diagonal().minCoeff() > std::sqrt(clearlyNoticed);
}

/// The generators of a variable, a row for each direction.
template <typename Numbers>
auto rowsOf(const Problem& problem, int variable, const std::vector<std::int64_t>& begin, Numbers& generators) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, gaugeDirections, Eigen::RowMajor>;
  using Matrix = std::conditional_t<std::is_const_v<Numbers>, const Rows, Rows>;
  const std::int64_t at = begin[static_cast<std::size_t>(problem.slotOfVariable(variable))];
  return Eigen::Map<Matrix, 0, Eigen::OuterStride<padded>>(generators.data() + std::max<std::int64_t>(at, 0),
                                                           at < 0 ? 0 : problem.dimension(variable), gaugeDirections);
}

/// gram = GᵀG over the vertices of a component.
void addVertices(const Problem& problem, const ComponentGauge& gauge, const std::vector<std::int64_t>& begin,
                 const std::vector<double>& generators, Generators& gram) {
  gram.setZero();
  for (const int variable : gauge.variables) {
    const auto G = rowsOf(problem, variable, begin, generators);
    gram += G.transpose() * G;
  }
}

/// Turns and growth about the middle of a component instead of the origin, if that is far away (as with UTM
/// coordinates): else J G is a small difference of large numbers, and what notices a turn a little is overlooked. About
/// the middle they are orthogonal to the shifts in GᵀG.
void centre(const Problem& problem, const ComponentGauge& gauge, const std::vector<std::int64_t>& begin,
            std::vector<double>& generators, Generators& gram) {
  constexpr int shifts = gaugeRoll, others = gaugeDirections - shifts;
  constexpr double farAway = 1e4;
  Eigen::Matrix<double, shifts, others> toShifts =
      gram.topLeftCorner<shifts, shifts>().completeOrthogonalDecomposition().solve(
          gram.topRightCorner<shifts, others>());
  const Eigen::Matrix<double, others, 1> before = gram.diagonal().tail<others>();
  const Eigen::Matrix<double, others, 1> removed =
      (gram.topRightCorner<shifts, others>().cwiseProduct(toShifts)).colwise().sum().transpose();
  const auto far = (before.array() > farAway * (before - removed).array().abs()).eval();
  if (!far.any()) return;
  for (int k = 0; k < others; ++k) {
    if (!far[k]) toShifts.col(k).setZero();
  }
  for (const int variable : gauge.variables) {
    auto G = rowsOf(problem, variable, begin, generators);
    G.rightCols<others>() -= G.leftCols<shifts>() * toShifts;
  }
  addVertices(problem, gauge, begin, generators, gram);
  // What is left of a turn that was but a shift, as of a single point, is rounding.
  constexpr double rounding = 1e-24;
  for (int k = shifts; k < gaugeDirections; ++k) {
    if (!far[k - shifts] || gram(k, k) > rounding * before[k - shifts]) continue;
    for (const int variable : gauge.variables) rowsOf(problem, variable, begin, generators).col(k).setZero();
    gram.row(k).setZero();
    gram.col(k).setZero();
  }
}

}  // namespace

std::vector<ComponentGauge> findGauges(const Problem& problem) {
  if (problem.variables() == 1 && problem.batches() > 0 && !problem.anyHeldDirections() && clearlyHeld(problem)) {
    ComponentGauge held;
    held.anchor = 0;
    held.variables = {0};
    return {held};
  }
  std::vector<int> componentOf;
  std::vector<ComponentGauge> gauges = components(problem, componentOf);
  std::vector<std::int64_t> begin;
  std::vector<double> generators = slotGenerators(problem, begin, componentOf, gauges);
  std::vector<Products> products(gauges.size());
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    addVertices(problem, gauges[i], begin, generators, products[i].gram);
    centre(problem, gauges[i], begin, generators, products[i].gram);
  }
  detail::addEdges({problem, begin, generators, componentOf}, products);
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    gauges[i].anchor = findAnchor(problem, gauges[i].variables);
    Combinations unseen(gaugeDirections, 0);
    gauges[i].free = gauges[i].tested ? freeDirections(products[i], unnoticed, unseen) : 0;
    if (gauges[i].free > 0)
      gauges[i].holds = detail::chooseHolds(problem, gauges[i], products[i].gram, unseen, generators, begin);
  }
  return gauges;
}

}  // namespace quiver
