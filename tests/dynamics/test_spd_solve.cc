// L D L^T against the product that it undoes.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "dynamics/spd_solve.h"

namespace limber::dynamics::test_spd_solve {
namespace {

MatrixJ random_matrix(int rows, int columns, std::mt19937& random) {
  std::normal_distribution<double> normal;
  MatrixJ out(rows, columns);
  for (int i = 0; i < out.size(); ++i) out(i) = normal(random);
  return out;
}

TEST(SpdSolve, UndoesTheProductForOneAndForSixRightSides) {
  std::mt19937 random(1);
  for (int n = 1; n <= kMaxJoints; ++n) {
    const MatrixJ A = random_matrix(n, n, random);
    MatrixJ M = A * A.transpose();
    M.diagonal().array() += 1.0;
    const MatrixJ6 X = random_matrix(n, 6, random);
    const Matrix6J J = (M * X).transpose();
    MatrixJ6 six(n, 6);
    Matrix6 G;
    VectorJ one = J.row(2);
    solve_spd(M, J, &six, &G);
    solve_spd(M, &one);
    EXPECT_LT((six - X).norm(), 1e-11 * X.norm()) << n;
    EXPECT_LT((one - X.col(2)).norm(), 1e-11 * X.norm()) << n;
    EXPECT_LT((G - X.transpose() * M * X).norm(), 1e-11 * G.norm()) << n;
  }
}

TEST(SpdSolve, InverseUndoesTheMatrix) {
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const Matrix6 A = random_matrix(6, 6, random);
    const Matrix6 G = A * A.transpose() + 0.1 * Matrix6::Identity();
    EXPECT_LT((inverse_spd(G) * G - Matrix6::Identity()).norm(), 1e-11);
  }
}

TEST(SpdSolve, WhatIsNotPositiveDefiniteGivesNoNumbers) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, std::nan(""), kInfinity, -kInfinity}) {
    for (const int n : {3, 4, 9}) {
      for (int i = 0; i < n; ++i) {
        MatrixJ M = MatrixJ::Identity(n, n);
        M(i, i) = bad;
        VectorJ x = VectorJ::Ones(n);
        solve_spd(M, &x);
        EXPECT_FALSE(x.allFinite()) << bad << " at " << i << " of " << n;
      }
    }
  }
}

// Both pivots of a pair negative have a positive determinant.
TEST(SpdSolve, NegativeDefiniteGivesNoNumbers) {
  VectorJ x = VectorJ::Ones(4);
  solve_spd(-MatrixJ::Identity(4, 4), &x);
  EXPECT_FALSE(x.allFinite());
  EXPECT_FALSE(inverse_spd(-Matrix6::Identity()).allFinite());
}

}  // namespace
}  // namespace limber::dynamics::test_spd_solve
