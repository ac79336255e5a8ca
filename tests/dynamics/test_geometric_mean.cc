// The geometric mean against its defining equation and against means known in closed form.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "common/joints.h"
#include "dynamics/geometric_mean.h"

namespace limber::dynamics::test_geometric_mean {
namespace {

using Eigen::MatrixXd;

// Positive definite, with eigenvalues over so many decades.
MatrixXd random_matrix(int n, double decades, std::mt19937* random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-0.5 * decades, 0.5 * decades);
  const MatrixXd Q =
      MatrixXd::NullaryExpr(n, n, [&] { return normal(*random); }).householderQr().householderQ();
  const Eigen::VectorXd s =
      Eigen::VectorXd::NullaryExpr(n, [&] { return std::pow(10.0, exponent(*random)); });
  return Q * s.asDiagonal() * Q.transpose();
}

// Of the largest entry that could stand there: sqrt(G_ii G_jj).
double relative_error(const MatrixXd& G, const MatrixXd& expected) {
  const Eigen::VectorXd size = expected.diagonal().cwiseSqrt().cwiseInverse();
  return (size.asDiagonal() * (G - expected) * size.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST(GeometricMean, SolvesItsEquation) {
  std::mt19937 random(1);
  for (int n = 1; n <= kMaxJoints; ++n) {
    for (int i = 0; i < 100; ++i) {
      const MatrixXd P = random_matrix(n, 2.0, &random), Q = random_matrix(n, 2.0, &random);
      MatrixXd G(n, n);
      ASSERT_TRUE(geometric_mean(P, Q, G)) << n;
      EXPECT_EQ((G - G.transpose()).norm(), 0.0);
      EXPECT_LT(relative_error(G * P.ldlt().solve(G), Q), 1e-11) << n;
      EXPECT_GT(G.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
    }
  }
}

// Cayley and Hamilton: the root of a 2 x 2 matrix A is (A + sqrt(det A)) / its trace.
TEST(GeometricMean, OfTwoByTwoInClosedForm) {
  std::mt19937 random(2);
  for (const double decades : {0.1, 2.0, 4.0}) {
    for (int i = 0; i < 100; ++i) {
      const Eigen::Matrix2d P = random_matrix(2, decades, &random),
                            Q = random_matrix(2, decades, &random);
      const double p = std::sqrt(P.determinant()), q = std::sqrt(Q.determinant());
      const Eigen::Matrix2d sum = P / p + Q / q;
      Eigen::Matrix2d G;
      ASSERT_TRUE(geometric_mean(P, Q, G));
      EXPECT_LT(relative_error(G, std::sqrt(p * q / sum.determinant()) * sum), 1e-9) << decades;
    }
  }
}

// What an arm has: grams on kilograms, one joint stiff and one soft.
TEST(GeometricMean, OfDiagonalMatricesIsTheRootOfEachProduct) {
  const Eigen::VectorXd p = (Eigen::VectorXd(6) << 1e-3, 2e-2, 5.0, 1.0, 0.3, 12.0).finished();
  const Eigen::VectorXd q = (Eigen::VectorXd(6) << 3000.0, 1e-2, 5.0, 900.0, 1.0, 1e4).finished();
  MatrixXd G(6, 6);
  ASSERT_TRUE(geometric_mean(MatrixXd(p.asDiagonal()), MatrixXd(q.asDiagonal()), G));
  EXPECT_LT(relative_error(G, MatrixXd(p.cwiseProduct(q).cwiseSqrt().asDiagonal())), 1e-14);
}

// A spring that leaves directions free: no entry of G acts in them.
TEST(GeometricMean, OfLowerRankSolvesItsEquationWithinTheRange) {
  std::mt19937 random(4);
  for (int n = 1; n <= kMaxJoints; ++n) {
    for (int rank = 0; rank < n; ++rank) {
      const MatrixXd P = random_matrix(n, 2.0, &random);
      const MatrixXd F = random_matrix(n, 1.0, &random).leftCols(rank);
      const MatrixXd Q = F * random_matrix(rank, 2.0, &random) * F.transpose();
      MatrixXd G(n, n);
      ASSERT_TRUE(geometric_mean(P, Q, G)) << n << ' ' << rank;
      EXPECT_EQ((G - G.transpose()).norm(), 0.0);
      EXPECT_LT((G * P.ldlt().solve(G) - Q).norm(), 1e-10 * Q.norm() + 1e-300) << n << ' ' << rank;
      const Eigen::VectorXd modes = G.selfadjointView<Eigen::Lower>().eigenvalues();
      for (int i = 0; i < n; ++i) {
        if (i < n - rank) {
          EXPECT_LE(std::abs(modes[i]), 1e-12 * G.norm()) << n << ' ' << rank;
        } else {
          EXPECT_GT(modes[i], 0.0);
        }
      }
    }
  }
}

// Of rank one, Q = v v^T: v v^T / sqrt(v^T P^-1 v).
TEST(GeometricMean, OfRankOneInClosedForm) {
  std::mt19937 random(5);
  const MatrixXd P = random_matrix(6, 1.0, &random);
  const Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(6, 1.0, 2.0);
  MatrixXd G(6, 6);
  ASSERT_TRUE(geometric_mean(P, MatrixXd(v * v.transpose()), G));
  EXPECT_LT(relative_error(G, v * v.transpose() / std::sqrt(v.dot(P.ldlt().solve(v)))), 1e-13);
}

TEST(GeometricMean, IsNotFoundWhereThereIsNone) {
  std::mt19937 random(3);
  const MatrixXd P = random_matrix(6, 1.0, &random);
  MatrixXd G(6, 6);
  EXPECT_FALSE(geometric_mean(MatrixXd::Zero(6, 6), P, G));
  EXPECT_FALSE(geometric_mean(P, -P, G));
  const Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(6, 1.0, 2.0);
  const MatrixXd one = v * v.transpose();
  EXPECT_FALSE(geometric_mean(one, P, G)) << "a mass that resists along one direction only";
  EXPECT_FALSE(geometric_mean(P, MatrixXd(one - 0.1 * MatrixXd::Identity(6, 6)), G));
  MatrixXd shear = MatrixXd::Zero(6, 6);
  shear(4, 1) = shear(1, 4) = 1.0;
  EXPECT_FALSE(geometric_mean(P, shear, G)) << "eigenvalues 1 and -1 without a diagonal";
  shear(0, 0) = 1.0;
  EXPECT_FALSE(geometric_mean(P, shear, G));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < 6; ++i) {
      MatrixXd Q = P;
      Q(i, 0) = Q(0, i) = bad;
      EXPECT_FALSE(geometric_mean(P, Q, G)) << i;
      EXPECT_FALSE(geometric_mean(Q, P, G)) << i;
      Q = one;
      Q(i, 0) = Q(0, i) = bad;
      EXPECT_FALSE(geometric_mean(P, Q, G)) << i << ", of rank one but for it";
    }
  }
}

}  // namespace
}  // namespace limber::dynamics::test_geometric_mean
