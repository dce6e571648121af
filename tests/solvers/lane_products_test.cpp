// Products of Jacobian blocks in lanes against loops over one edge at a time: every compiled size and some others, on
// every instruction set of the machine, records and blocks apart, shared by some edges and shared by all.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include <quiver/solvers/assembly/lane_products.h>

namespace quiver {
namespace {

constexpr int lanes = 8;

std::vector<InstructionSet> instructionSets() {
  std::vector<InstructionSet> sets{InstructionSet::generic};
  const InstructionSet best = detectInstructionSet();
  if (best != InstructionSet::generic) sets.push_back(InstructionSet::avx2);
  if (best == InstructionSet::avx512) sets.push_back(best);
  return sets;
}

class Numbers {
 public:
  std::vector<double> some(int count) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (double& value : values) value = uniform_(random_);
    return values;
  }

 private:
  std::mt19937_64 random_{7};
  std::uniform_real_distribution<double> uniform_{-2.0, 2.0};
};

/// Entry (r, c) of an edge's block in lanes.
double entry(const std::vector<double>& block, int rows, int r, int c, int edge) {
  return block[static_cast<std::size_t>((c * rows + r) * lanes + edge)];
}

/// Which record each edge adds to: all apart, some shared, side by side or not, and one for all.
const std::vector<std::vector<int>> sharing{
    {0, 1, 2, 3, 4, 5, 6, 7}, {0, 0, 1, 1, 0, 2, 2, 2}, {3, 3, 3, 3, 3, 3, 3, 3}, {0, 0, 0, 0, 0, 0, 0, 1}};

void expectSquare(InstructionSet set, int rows, int columns, const std::vector<int>& record) {
  Numbers numbers;
  const std::vector<double> J = numbers.some(rows * columns * lanes);
  const std::vector<double> residual = numbers.some(rows * lanes);
  const int padded = LaneProducts::paddedSize(columns);
  std::vector<double> sums = numbers.some(lanes * padded);
  std::vector<double> expected = sums;
  for (int edge = 0; edge < lanes; ++edge) {
    double* out = expected.data() + record[static_cast<std::size_t>(edge)] * padded;
    for (int a = 0; a < columns; ++a) {
      for (int b = a; b < columns; ++b, ++out) {
        for (int r = 0; r < rows; ++r) *out += entry(J, rows, r, a, edge) * entry(J, rows, r, b, edge);
      }
    }
    for (int a = 0; a < columns; ++a, ++out) {
      for (int r = 0; r < rows; ++r) *out += entry(J, rows, r, a, edge) * entry(residual, rows, r, 0, edge);
    }
  }
  double* out[lanes];
  for (int edge = 0; edge < lanes; ++edge) out[edge] = sums.data() + record[static_cast<std::size_t>(edge)] * padded;
  LaneProducts::square(set, rows, columns)(J.data(), residual.data(), rows, columns, out);
  for (std::size_t i = 0; i < sums.size(); ++i)
    ASSERT_NEAR(sums[i], expected[i], 1e-12) << rows << " rows, " << columns << " columns, number " << i;
}

TEST(LaneProducts, SquaresAreThoseOfEveryEdge) {
  for (const InstructionSet set : instructionSets()) {
    for (const int rows : {1, 2, 3, 5, 6}) {
      for (int columns = 1; columns <= 11; ++columns) {
        for (const std::vector<int>& record : sharing) expectSquare(set, rows, columns, record);
      }
    }
  }
}

void expectCross(InstructionSet set, int rows, int columnsA, int columnsB, unsigned flipped) {
  Numbers numbers;
  const std::vector<double> A = numbers.some(rows * columnsA * lanes);
  const std::vector<double> B = numbers.some(rows * columnsB * lanes);
  const int size = columnsA * columnsB;
  constexpr double untouched = 99.0;
  std::vector<double> blocks(static_cast<std::size_t>(lanes * (size + 1)), untouched);
  double* out[lanes];
  std::int64_t flip[lanes];
  for (int edge = 0; edge < lanes; ++edge) {
    out[edge] = blocks.data() + edge * (size + 1);
    flip[edge] = (flipped >> edge & 1) != 0 ? -1 : 0;
  }
  LaneProducts::cross(set, rows, columnsA, columnsB)(A.data(), B.data(), rows, columnsA, columnsB, flip, out);
  for (int edge = 0; edge < lanes; ++edge) {
    for (int a = 0; a < columnsA; ++a) {
      for (int b = 0; b < columnsB; ++b) {
        double product = 0.0;
        for (int r = 0; r < rows; ++r) product += entry(A, rows, r, a, edge) * entry(B, rows, r, b, edge);
        ASSERT_NEAR(out[edge][flip[edge] != 0 ? a * columnsB + b : b * columnsA + a], product, 1e-12)
            << rows << " rows, " << columnsA << " × " << columnsB << ", edge " << edge;
      }
    }
    ASSERT_EQ(out[edge][size], untouched) << "behind the block of edge " << edge;
  }
}

TEST(LaneProducts, CrossProductsAreThoseOfEveryEdge) {
  for (const InstructionSet set : instructionSets()) {
    for (const int rows : {1, 2, 3, 6}) {
      for (const int columnsA : {1, 2, 3, 6, 9}) {
        for (const int columnsB : {1, 2, 3, 4, 6, 8, 9}) {
          for (const unsigned flipped : {0U, 0xffU, 0x35U, 0x80U}) expectCross(set, rows, columnsA, columnsB, flipped);
        }
      }
    }
  }
}

void expectAddedCross(InstructionSet set, int rows, int columnsA, int columnsB, const std::vector<int>& record,
                      unsigned flipped) {
  Numbers numbers;
  const std::vector<double> A = numbers.some(rows * columnsA * lanes);
  const std::vector<double> B = numbers.some(rows * columnsB * lanes);
  const int padded = (columnsA * columnsB + lanes - 1) / lanes * lanes;
  std::vector<double> blocks = numbers.some(padded * lanes);
  std::vector<double> expected = blocks;
  double* out[lanes];
  std::int64_t flip[lanes];
  for (int edge = 0; edge < lanes; ++edge) {
    const int begin = record[static_cast<std::size_t>(edge)] * padded;
    out[edge] = blocks.data() + begin;
    flip[edge] = (flipped >> edge & 1) != 0 ? -1 : 0;
    for (int a = 0; a < columnsA; ++a) {
      for (int b = 0; b < columnsB; ++b) {
        double& number = expected[static_cast<std::size_t>(begin + (flip[edge] ? a * columnsB + b : b * columnsA + a))];
        for (int r = 0; r < rows; ++r) number += entry(A, rows, r, a, edge) * entry(B, rows, r, b, edge);
      }
    }
  }
  LaneProducts::addedCross(set, rows, columnsA, columnsB)(A.data(), B.data(), rows, columnsA, columnsB, flip, out);
  for (std::size_t i = 0; i < blocks.size(); ++i)
    ASSERT_NEAR(blocks[i], expected[i], 1e-12)
        << rows << " rows, " << columnsA << " × " << columnsB << ", number " << i;
}

TEST(LaneProducts, AddedCrossProductsAreThoseOfEveryEdge) {
  for (const InstructionSet set : instructionSets()) {
    for (const int rows : {1, 2, 3}) {
      for (const int columnsA : {1, 2, 3, 6}) {
        for (const int columnsB : {1, 3, 4, 6, 9}) {
          for (const unsigned flipped : {0U, 0xffU, 0x35U}) {
            for (const std::vector<int>& record : sharing)
              expectAddedCross(set, rows, columnsA, columnsB, record, flipped);
          }
        }
      }
    }
  }
}

TEST(LaneProducts, SumsAreThoseOfAllGroups) {
  constexpr int groups = 5;
  for (const InstructionSet set : instructionSets()) {
    for (const int rows : {1, 2, 3, 6}) {
      for (const int columns : {1, 2, 3, 6, 7}) {
        Numbers numbers;
        const std::vector<double> J = numbers.some(groups * rows * columns * lanes);
        const std::vector<double> residual = numbers.some(groups * rows * lanes);
        const std::vector<double> weights = numbers.some(groups * lanes);
        std::vector<double> sums = numbers.some(LaneProducts::squareSize(columns) * lanes);
        std::vector<double> expected = sums;
        for (int g = 0; g < groups; ++g) {
          const auto column = [&](int c, int r, int lane) {
            const std::vector<double>& from = c < columns ? J : residual;
            const int at = c < columns ? (g * columns + c) * rows + r : g * rows + r;
            return from[static_cast<std::size_t>(at * lanes + lane)];
          };
          for (int lane = 0; lane < lanes; ++lane) {
            const double weight = std::max(weights[static_cast<std::size_t>(g * lanes + lane)], 0.0);
            std::size_t at = static_cast<std::size_t>(lane);
            for (int a = 0; a < columns; ++a) {
              for (int b = a; b < columns; ++b, at += lanes) {
                for (int r = 0; r < rows; ++r) expected[at] += weight * column(a, r, lane) * column(b, r, lane);
              }
            }
            for (int a = 0; a < columns; ++a, at += lanes) {
              for (int r = 0; r < rows; ++r) expected[at] += weight * column(a, r, lane) * column(columns, r, lane);
            }
          }
        }
        LaneProducts::sum(set, rows, columns)(J.data(), residual.data(), weights.data(), rows, columns, groups,
                                              sums.data());
        for (std::size_t i = 0; i < sums.size(); ++i) ASSERT_NEAR(sums[i], expected[i], 1e-12) << i;
      }
    }
  }
}

}  // namespace
}  // namespace quiver
