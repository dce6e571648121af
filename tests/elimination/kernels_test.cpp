#include <random>

#include <gtest/gtest.h>
#include <quiver/core/util/aligned_buffer.h>
#include <quiver/solvers/elimination/kernels/elimination_level.h>
#include <Eigen/Dense>

namespace quiver::test {
namespace {

using detail::EliminationKernels;

/// Sums of at most some tens of products of numbers about 1.
constexpr double tolerance = 1e-12;
constexpr int lanes = 8;

struct Sizes {
  int N, k, e;
};
/// Those compiled as constants and some that are not.
constexpr Sizes sizes[] = {{2, 9, 3}, {2, 7, 3}, {2, 6, 3}, {2, 3, 3}, {3, 6, 3},  {2, 6, 1},  {2, 3, 2}, {1, 3, 2},
                           {3, 9, 2}, {1, 1, 1}, {2, 8, 4}, {4, 5, 6}, {2, 10, 3}, {2, 17, 1}, {6, 12, 5}};

class Kernels : public testing::TestWithParam<detail::KernelLevel> {
 protected:
  const EliminationKernels& set() const { return detail::eliminationKernels(GetParam()); }
  AlignedBuffer randomLanes(int numbers) {
    AlignedBuffer buffer(std::int64_t{numbers} * lanes + 64);
    for (std::int64_t i = 0; i < buffer.size(); ++i) buffer[i] = normal_(random_);
    return buffer;
  }
  /// Lane `lane` of column-major blocks in lanes.
  static Eigen::MatrixXd laneOf(const AlignedBuffer& buffer, int rows, int columns, int lane) {
    return Eigen::MatrixXd::NullaryExpr(
        rows, columns, [&](Eigen::Index r, Eigen::Index c) { return buffer[(c * rows + r) * lanes + lane]; });
  }
  /// V and g of a lane's sums.
  static Eigen::MatrixXd squareOf(const AlignedBuffer& sums, int e, int lane) {
    Eigen::MatrixXd V(e, e);
    for (int a = 0, at = 0; a < e; ++a) {
      for (int b = a; b < e; ++b, ++at) V(a, b) = V(b, a) = sums[at * lanes + lane];
    }
    return V;
  }
  static Eigen::VectorXd rightOf(const AlignedBuffer& sums, int e, int lane) {
    return Eigen::VectorXd::NullaryExpr(e, [&](Eigen::Index j) { return sums[(e * (e + 1) / 2 + j) * lanes + lane]; });
  }
  /// Sums of enough rows that V is well conditioned.
  AlignedBuffer pointSums(int e) {
    AlignedBuffer sums(std::int64_t{detail::pointNumbers(e)} * lanes);
    for (int i = 0; i < 8; ++i) {
      const AlignedBuffer J = randomLanes(e * e);
      const AlignedBuffer r = randomLanes(e);
      set().addPoint(e, e)(J.data(), r.data(), e, e, sums.data());
    }
    return sums;
  }

  std::mt19937 random_{5};
  std::normal_distribution<double> normal_;
};

TEST_P(Kernels, AddPointsSquares) {
  for (const auto& [N, k, e] : sizes) {
    const AlignedBuffer J = randomLanes(N * e);
    const AlignedBuffer r = randomLanes(N);
    AlignedBuffer sums = randomLanes(detail::pointNumbers(e));
    const AlignedBuffer before = sums;
    set().addPoint(N, e)(J.data(), r.data(), N, e, sums.data());
    for (int lane = 0; lane < lanes; ++lane) {
      const Eigen::MatrixXd block = laneOf(J, N, e, lane);
      EXPECT_LT((squareOf(sums, e, lane) - squareOf(before, e, lane) - block.transpose() * block).norm(), tolerance);
      EXPECT_LT((rightOf(sums, e, lane) - rightOf(before, e, lane) - block.transpose() * laneOf(r, N, 1, lane)).norm(),
                tolerance);
    }
  }
}

TEST_P(Kernels, FactorAndSolvePoints) {
  for (const auto& [N, k, e] : sizes) {
    const AlignedBuffer sums = pointSums(e);
    AlignedBuffer damping = randomLanes(e);
    for (int i = 0; i < e * lanes; ++i) damping[i] = std::abs(damping[i]);
    AlignedBuffer factor(std::int64_t{detail::pointNumbers(e)} * lanes);
    double dropped[lanes];
    set().factorPoint(e)(sums.data(), damping.data(), e, 1e-13, factor.data(), dropped);
    AlignedBuffer t = randomLanes(e);
    const AlignedBuffer right = t;
    set().solvePoint(e)(factor.data(), e, t.data());
    for (int lane = 0; lane < lanes; ++lane) {
      EXPECT_EQ(dropped[lane], 0.0);
      const Eigen::MatrixXd V = squareOf(sums, e, lane) + Eigen::MatrixXd(laneOf(damping, e, 1, lane).asDiagonal());
      EXPECT_LT((V * laneOf(t, e, 1, lane) - laneOf(right, e, 1, lane)).norm(), tolerance * V.norm());
      const Eigen::MatrixXd L = V.llt().matrixL();
      EXPECT_LT((rightOf(factor, e, lane) - L.triangularView<Eigen::Lower>().solve(rightOf(sums, e, lane))).norm(),
                tolerance * V.norm());
    }
  }
}

TEST_P(Kernels, LeaveOutSingularDirections) {
  constexpr int e = 3;
  AlignedBuffer sums = pointSums(e);
  // Lane 2: the second direction is twice the first; lane 5: nothing is known at all.
  for (int m = 0; m < detail::pointNumbers(e); ++m) sums[m * lanes + 5] = 0.0;
  const double V[] = {4.0, 8.0, 1.0, 16.0, 2.0, 5.0};
  for (int m = 0; m < 6; ++m) sums[m * lanes + 2] = V[m];
  AlignedBuffer damping(e * lanes);
  AlignedBuffer factor(std::int64_t{detail::pointNumbers(e)} * lanes);
  double dropped[lanes];
  set().factorPoint(e)(sums.data(), damping.data(), e, 1e-13, factor.data(), dropped);
  AlignedBuffer t = randomLanes(e);
  set().solvePoint(e)(factor.data(), e, t.data());
  for (int lane = 0; lane < lanes; ++lane) EXPECT_EQ(dropped[lane], lane == 2 ? 1.0 : lane == 5 ? 3.0 : 0.0);
  EXPECT_EQ(t[1 * lanes + 2], 0.0);
  EXPECT_NE(t[0 * lanes + 2], 0.0);
  for (int j = 0; j < e; ++j) EXPECT_EQ(t[j * lanes + 5], 0.0);
}

TEST_P(Kernels, ReduceRowsToRecords) {
  for (const auto& [N, k, e] : sizes) {
    const AlignedBuffer sums = pointSums(e);
    const AlignedBuffer damping(std::int64_t{e} * lanes);
    AlignedBuffer factor(std::int64_t{detail::pointNumbers(e)} * lanes);
    double dropped[lanes];
    set().factorPoint(e)(sums.data(), damping.data(), e, 1e-13, factor.data(), dropped);
    const AlignedBuffer Jk = randomLanes(N * k);
    const AlignedBuffer Je = randomLanes(N * e);
    AlignedBuffer scratch(std::int64_t{N} * e * lanes);
    const int size = detail::recordSize(k, e);
    AlignedBuffer memory(std::int64_t{size} * lanes);
    double* records[lanes];
    for (int lane = 0; lane < lanes; ++lane) records[lane] = memory.data() + (lane * 3 % lanes) * size;
    for (const bool add : {false, true}) {
      set().reduceRow(N, k, e)(Jk.data(), Je.data(), factor.data(), N, k, e, add, scratch.data(), records);
      for (int lane = 0; lane < lanes; ++lane) {
        const Eigen::MatrixXd L = squareOf(sums, e, lane).llt().matrixL();
        const Eigen::MatrixXd W = laneOf(Jk, N, k, lane).transpose() * laneOf(Je, N, e, lane);
        const Eigen::MatrixXd Z = L.triangularView<Eigen::Lower>().solve(W.transpose()).transpose();
        for (int c = 0; c < e; ++c) {
          for (int r = 0; r < k; ++r)
            EXPECT_NEAR(records[lane][detail::recordEntry(k, e, r, c)], (add ? 2.0 : 1.0) * Z(r, c), tolerance * 10);
          EXPECT_NEAR(records[lane][detail::recordEntry(k, e, k, c)], rightOf(factor, e, lane)[c], tolerance);
        }
      }
    }
  }
}

TEST_P(Kernels, MultiplyRowsBothWays) {
  for (const auto& [N, k, e] : sizes) {
    const AlignedBuffer J = randomLanes(N * k);
    AlignedBuffer u = randomLanes(N);
    AlignedBuffer t = randomLanes(k);
    const AlignedBuffer uBefore = u;
    const AlignedBuffer tBefore = t;
    const int padded = (k + 7) / 8 * 8;
    AlignedBuffer x = randomLanes(padded);
    const AlignedBuffer xBefore = x;
    double* vectors[lanes];
    for (int lane = 0; lane < lanes; ++lane) vectors[lane] = x.data() + lane * padded;
    set().multiplyRow(N, k)(J.data(), vectors, N, k, u.data());
    set().transposedRow(N, k)(J.data(), u.data(), N, k, t.data());
    for (int lane = 0; lane < lanes; ++lane) {
      const Eigen::Map<const Eigen::VectorXd> own(xBefore.data() + lane * padded, k);
      const Eigen::MatrixXd block = laneOf(J, N, k, lane);
      EXPECT_LT((laneOf(u, N, 1, lane) - laneOf(uBefore, N, 1, lane) - block * own).norm(), tolerance);
      EXPECT_LT(
          (laneOf(t, k, 1, lane) - laneOf(tBefore, k, 1, lane) - block.transpose() * laneOf(u, N, 1, lane)).norm(),
          tolerance);
    }
    set().scatterRow(N, k)(J.data(), u.data(), N, k, vectors);
    for (int lane = 0; lane < lanes; ++lane) {
      const Eigen::VectorXd expected = Eigen::Map<const Eigen::VectorXd>(xBefore.data() + lane * padded, k) +
                                       laneOf(J, N, k, lane).transpose() * laneOf(u, N, 1, lane);
      EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(vectors[lane], k) - expected).norm(), tolerance);
    }
  }
}

TEST_P(Kernels, SubtractProductsOfRecords) {
  for (const auto& [N, kRow, e] : sizes) {
    for (const int kColumn : {kRow, 3, 6, 11}) {
      constexpr int count = 5;
      const int rowSize = detail::recordSize(kRow, e);
      const int columnSize = detail::recordSize(kColumn, e);
      const AlignedBuffer tile = randomLanes(2 * count * std::max(rowSize, columnSize));
      std::vector<detail::RecordPair> pairs;
      std::vector<detail::RecordPair> own;
      for (int p = 0; p < count; ++p) {
        pairs.push_back({static_cast<std::uint16_t>(p * rowSize / 8),
                         static_cast<std::uint16_t>((count * rowSize + (count - 1 - p) * columnSize) / 8)});
        own.push_back({pairs.back().row, pairs.back().row});
      }
      const auto record = [&](std::uint16_t place, int k) {
        return Eigen::MatrixXd::NullaryExpr(
                   k + 1, e,
                   [&tile, place, k, e = e](Eigen::Index r, Eigen::Index c) {
                     return tile[place * 8 + detail::recordEntry(k, e, static_cast<int>(r), static_cast<int>(c))];
                   })
            .eval();
      };
      const Eigen::MatrixXd before = Eigen::MatrixXd::Random(kRow, kColumn);
      Eigen::MatrixXd expected = before;
      for (const auto& pair : pairs)
        expected -= record(pair.row, kRow).topRows(kRow) * record(pair.column, kColumn).topRows(kColumn).transpose();
      Eigen::MatrixXd block = before;
      set().subtractPairs(kRow, kColumn, e)(tile.data(), pairs.data(), count, kRow, kColumn, e, block.data());
      EXPECT_LT((block - expected).norm(), tolerance * 10) << kRow << ' ' << kColumn << ' ' << e;

      Eigen::MatrixXd square = Eigen::MatrixXd::Zero(kRow, kRow);
      Eigen::VectorXd right = Eigen::VectorXd::Ones(kRow);
      set().subtractSquares(kRow, e)(tile.data(), own.data(), count, kRow, e, square.data(), right.data());
      for (const auto& pair : own) {
        const Eigen::MatrixXd Z = record(pair.row, kRow);
        square += Z.topRows(kRow) * Z.topRows(kRow).transpose();
        right += Z.topRows(kRow) * Z.row(kRow).transpose();
      }
      EXPECT_LT(square.norm(), tolerance * 10) << kRow << ' ' << e;
      EXPECT_LT((right - Eigen::VectorXd::Ones(kRow)).norm(), tolerance * 10) << kRow << ' ' << e;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Levels, Kernels, testing::ValuesIn(detail::availableKernelLevels()),
                         [](const auto& info) { return std::string(detail::eliminationKernels(info.param).name); });

}  // namespace
}  // namespace quiver::test
