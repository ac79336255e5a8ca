// L D L^T against the product that it undoes.
#include <gtest/gtest.h>

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
    MatrixJ6 six = M * X;
    VectorJ one = six.col(2);
    solve_spd(M, &six);
    solve_spd(M, &one);
    EXPECT_LT((six - X).norm(), 1e-11 * X.norm()) << n;
    EXPECT_LT((one - X.col(2)).norm(), 1e-11 * X.norm()) << n;
  }
}

TEST(SpdSolve, WhatIsNotPositiveDefiniteGivesNoNumbers) {
  for (const double last : {0.0, -1.0, std::nan("")}) {
    MatrixJ M = MatrixJ::Identity(3, 3);
    M(2, 2) = last;
    VectorJ x = VectorJ::Ones(3);
    solve_spd(M, &x);
    EXPECT_FALSE(x.allFinite()) << last;
  }
}

}  // namespace
}  // namespace limber::dynamics::test_spd_solve
