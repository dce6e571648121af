#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <quiver/core/io/g2o/information_check.h>

namespace quiver::detail {
namespace {

std::vector<double> triangleOf(const Eigen::MatrixXd& matrix) {
  std::vector<double> triangle;
  for (int r = 0; r < matrix.rows(); ++r) {
    for (int c = r; c < matrix.cols(); ++c) triangle.push_back(matrix(r, c));
  }
  return triangle;
}

Eigen::MatrixXd withEigenvalues(const Eigen::VectorXd& values, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto n = static_cast<int>(values.size());
  const Eigen::MatrixXd noise = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
  const Eigen::MatrixXd basis = Eigen::HouseholderQR<Eigen::MatrixXd>(noise).householderQ();
  return basis * values.asDiagonal() * basis.transpose();
}

TEST(InformationCheck, DecidesByTheLeastEigenvalue) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  InformationCheck check;
  for (int i = 0; i < 2000; ++i) {
    const int n = 1 + i % 9;
    Eigen::VectorXd values = Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(random); });
    values[0] = 1.0;
    // Clear of the limit of −1e-6 by a factor of two: the matrix itself is rounded.
    const bool bad = n > 1 && i % 2 == 0;
    if (n > 1) values[1] = bad ? -2e-6 : -5e-7;
    const double scale = std::pow(10.0, static_cast<double>(random() % 600) - 300.0);
    EXPECT_EQ(check.accepts(triangleOf(scale * withEigenvalues(values, random)), n), !bad) << n << " " << scale;
  }
}

TEST(InformationCheck, KnowsTheEdges) {
  InformationCheck check;
  EXPECT_TRUE(check.accepts(std::vector<double>{0.0}, 1));
  EXPECT_TRUE(check.accepts(std::vector<double>{0, 0, 0, 0, 0, 0}, 3));
  EXPECT_FALSE(check.accepts(std::vector<double>{-1e-300}, 1));
  EXPECT_FALSE(check.accepts(std::vector<double>{0, 1, 0}, 2));
  EXPECT_TRUE(check.accepts(std::vector<double>{1, 1, 1}, 2));
  EXPECT_TRUE(check.accepts(std::vector<double>{1e308, 0, 1e308}, 2));
  EXPECT_TRUE(check.accepts(std::vector<double>{1e308, 1e308, 1e308}, 2));
  EXPECT_FALSE(check.accepts(std::vector<double>{1e308, -1.7e308, 1e308}, 2));
}

TEST(InformationCheck, RemembersAcceptedMatricesOnly) {
  InformationCheck check;
  const std::vector<double> good{1, 0, 1};
  const std::vector<double> bad{1, 2, 1};
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(check.accepts(good, 2));
    EXPECT_FALSE(check.accepts(bad, 2));
  }
}

TEST(ClampInformation, RaisesNegativeEigenvaluesToZero) {
  std::mt19937_64 random(10);
  for (int i = 0; i < 200; ++i) {
    const int n = 1 + i % 7;
    const Eigen::VectorXd values =
        Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index k) { return k % 2 ? -1.0 - k : 1.0 + k; });
    std::mt19937_64 again = random;
    std::vector<double> triangle = triangleOf(withEigenvalues(values, random));
    const std::vector<double> expected = triangleOf(withEigenvalues(values.cwiseMax(0.0), again));
    clampInformation(triangle, n);
    InformationCheck check;
    EXPECT_TRUE(check.accepts(triangle, n));
    for (std::size_t k = 0; k < triangle.size(); ++k) EXPECT_NEAR(triangle[k], expected[k], 1e-13 * n * n);
  }
}

TEST(EigenvalueRange, SpansTheEigenvalues) {
  const EigenvalueRange range = eigenvalueRange(std::vector<double>{1, 2, 0, 1, 0, 7}, 3);
  EXPECT_NEAR(range.least, -1.0, 1e-14);
  EXPECT_NEAR(range.most, 7.0, 1e-13);
}

}  // namespace
}  // namespace quiver::detail
