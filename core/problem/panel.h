#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/util/aligned_buffer.h>

namespace quiver {

/// Sizes of one edge's linearisation: `rows` of the error, and the tangent dimension of the vertex at each role.
struct EdgeShape {
  int rows = 0;
  std::vector<int> columns;

  bool operator==(const EdgeShape&) const = default;
};

/// What an edge batch writes for up to 64 edges, in memory of the caller: whitened residuals r = √ρ' U e with UᵀU = Ω,
/// Jacobian blocks J = √ρ' U ∂e/∂δ, so that JᵀJ and Jᵀr are the edge's part of the normal equations (with the
/// second-order correction both are corrected so that they still are), and per edge eᵀΩe, ρ and ρ'.
///
/// Numbers lie in lanes: edges are taken in groups of eight, and entry k of the eight edges of a group are neighbours:
/// residual row r of edge i is residual[((i / 8) * rows + r) * 8 + i % 8]; column-major entry (r, c) of role a's block
/// is jacobian[a][((i / 8) * rows * columns[a] + c * rows + r) * 8 + i % 8]. Lanes beyond the last edge hold finite
/// rubbish or a repetition.
struct Panel {
  static constexpr int lanes = 8;
  static constexpr int capacity = 64;

  double* residual = nullptr;
  double* const* jacobian = nullptr;
  double* squaredError = nullptr;
  double* cost = nullptr;
  double* weight = nullptr;
  /// False asks for r and J without √ρ', to be multiplied by `weight` where their products are formed.
  bool weighed = true;
};

/// Memory for panels of one shape (the largest of a batch) and at most so many edges, which are rounded up to whole
/// groups. Reused from call to call; one per thread.
class PanelBuffer {
 public:
  PanelBuffer() = default;
  explicit PanelBuffer(const EdgeShape& shape, bool withJacobians = true, int edges = Panel::capacity) {
    const std::int64_t capacity = std::int64_t{(edges + Panel::lanes - 1) / Panel::lanes} * Panel::lanes;
    std::int64_t size = capacity * (shape.rows + 3);
    if (withJacobians) {
      for (const int columns : shape.columns) size += capacity * shape.rows * columns;
    }
    memory_ = AlignedBuffer(size);
    double* next = memory_.data();
    const auto take = [&next](std::int64_t count) {
      double* begin = next;
      next += count;
      return begin;
    };
    panel_.squaredError = take(capacity);
    panel_.cost = take(capacity);
    panel_.weight = take(capacity);
    panel_.residual = take(capacity * shape.rows);
    if (withJacobians) {
      for (const int columns : shape.columns) jacobians_.push_back(take(capacity * shape.rows * columns));
    }
  }
  PanelBuffer(PanelBuffer&&) noexcept = default;
  PanelBuffer& operator=(PanelBuffer&&) noexcept = default;

  const Panel& panel() {
    panel_.jacobian = jacobians_.data();
    return panel_;
  }

 private:
  AlignedBuffer memory_;
  std::vector<double*> jacobians_;
  Panel panel_;
};

}  // namespace quiver
