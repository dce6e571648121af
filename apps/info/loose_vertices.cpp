#include <quiver/apps/info/loose_vertices.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

namespace quiver::app {
namespace {

/// The diagonal blocks of H, each full and column by column.
class DiagonalBlocks {
 public:
  explicit DiagonalBlocks(const Problem& problem) : problem_(problem) {
    begin_.push_back(0);
    for (int v = 0; v < problem.variables(); ++v) {
      const auto n = static_cast<std::size_t>(problem.dimension(v));
      begin_.push_back(begin_.back() + n * n);
    }
    values_.assign(begin_.back(), 0.0);
    for (int b = 0; b < problem.batches(); ++b) addBatch(problem.batch(b));
  }

  Eigen::MatrixXd block(int variable) const {
    const int n = problem_.dimension(variable);
    return Eigen::Map<const Eigen::MatrixXd>(values_.data() + begin_[static_cast<std::size_t>(variable)], n, n);
  }

 private:
  void addBatch(const EdgeBatch& batch) {
    const int step = batch.uniform() ? Panel::capacity : 1;
    PanelBuffer buffer(batch.largestShape(), true, step);
    const Panel& panel = buffer.panel();
    std::vector<std::int32_t> list;
    for (int begin = 0; begin < batch.size(); begin += step) {
      list.resize(static_cast<std::size_t>(std::min(step, batch.size() - begin)));
      std::iota(list.begin(), list.end(), begin);
      batch.linearize(problem_.state(), list, panel);
      for (std::size_t i = 0; i < list.size(); ++i) addEdge(batch, list[i], static_cast<int>(i), panel);
    }
  }

  /// JᵀJ of every role; `place` is the edge's in the panel.
  void addEdge(const EdgeBatch& batch, int edge, int place, const Panel& panel) {
    const EdgeShape shape = batch.shape(edge);
    const auto slots = batch.slots(edge);
    for (std::size_t role = 0; role < slots.size(); ++role) {
      const int variable = problem_.variableOfSlot(slots[role]);
      if (variable < 0) continue;
      const int columns = shape.columns[role];
      const double* J =
          panel.jacobian[role] + place / Panel::lanes * shape.rows * columns * Panel::lanes + place % Panel::lanes;
      const auto entry = [&](int row, int column) { return J[(column * shape.rows + row) * Panel::lanes]; };
      double* block = values_.data() + begin_[static_cast<std::size_t>(variable)];
      for (int a = 0; a < columns; ++a) {
        for (int b = 0; b < columns; ++b) {
          for (int row = 0; row < shape.rows; ++row) block[b * columns + a] += entry(row, a) * entry(row, b);
        }
      }
    }
  }

  const Problem& problem_;
  std::vector<std::size_t> begin_;
  std::vector<double> values_;
};

/// "x [m]", or "0.71 x [m] - 0.71 y [m]" between axes.
std::string nameOf(const Eigen::VectorXd& direction, const std::vector<std::string>& names) {
  constexpr double visible = 0.05, alone = 0.995;
  std::string text;
  for (int i = 0; i < direction.size(); ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (std::abs(direction[i]) > alone) return name;
    if (std::abs(direction[i]) < visible) continue;
    const bool negative = direction[i] < 0.0;
    text += text.empty() ? (negative ? "-" : "") : (negative ? " - " : " + ");
    text += fmt::format("{:.2f} {}", std::abs(direction[i]), name);
  }
  return text;
}

/// Directions in which the block is zero to rounding, in coordinates scaled by its diagonal, so that metres and radians
/// compare.
std::vector<std::string> looseDirections(const Problem& problem, int variable, Eigen::MatrixXd block) {
  constexpr double rounding = 1e-12;
  for (int c = 0; c < block.cols(); ++c) {
    if (problem.heldDirections(variable) >> c & 1) {
      block.row(c).setZero();
      block.col(c).setZero();
      block(c, c) = 1.0;
    }
  }
  std::vector<std::string> loose;
  if (!block.allFinite()) return loose;
  const Eigen::VectorXd scale = block.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (scale.array() > 0.0).select(scale.cwiseInverse(), 1.0);
  const Eigen::MatrixXd scaled = inverse.asDiagonal() * block * inverse.asDiagonal();
  if (scaled.llt().info() == Eigen::Success && scaled.llt().rcond() > rounding) return loose;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const std::vector<std::string> names =
      problem.vertexType(problem.slotOfVariable(variable)).tangentNames(problem.dimension(variable));
  for (int i = 0; i < eigen.eigenvalues().size(); ++i) {
    if (eigen.eigenvalues()[i] > rounding) continue;
    loose.push_back(nameOf((inverse.asDiagonal() * eigen.eigenvectors().col(i)).normalized(), names));
  }
  return loose;
}

}  // namespace

std::vector<LooseVertex> findLooseVertices(const Problem& problem) {
  const DiagonalBlocks blocks(problem);
  std::vector<LooseVertex> result;
  for (int v = 0; v < problem.variables(); ++v) {
    std::vector<std::string> directions = looseDirections(problem, v, blocks.block(v));
    if (!directions.empty()) result.push_back({&problem.vertex(problem.slotOfVariable(v)), std::move(directions)});
  }
  std::sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.vertex->id() < b.vertex->id(); });
  return result;
}

}  // namespace quiver::app
