// The templates that are compiled once are there and right, for every type: [2 1; 1 2] has the
// eigenvalues 1 and 3 and the Cholesky factor [sqrt 2, 0; 1/sqrt 2, sqrt 1.5].
#include <gtest/gtest.h>

#include <cmath>

#include "common/eigen_templates.h"

namespace limber::test_eigen_templates {
namespace {

template <typename Matrix>
Matrix two_by_two_and(int rest) {
  Matrix M = 5.0 * Matrix::Identity(2 + rest, 2 + rest);
  M.template topLeftCorner<2, 2>() << 2.0, 1.0, 1.0, 2.0;
  return M;
}

template <typename Matrix>
void expect_eigenvalues(const Matrix& M) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(M);
  EXPECT_NEAR(eigen.eigenvalues()[0], 1.0, 1e-14);
  EXPECT_NEAR(eigen.eigenvalues()[1], 3.0, 1e-14);
  EXPECT_NEAR(std::abs(eigen.eigenvectors()(0, 0)), std::sqrt(0.5), 1e-14);
}

template <typename Matrix>
void expect_factor(const Matrix& M) {
  const Matrix L = Eigen::LLT<Matrix>(M).matrixL();
  EXPECT_NEAR(L(0, 0), std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(L(1, 0), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(L(1, 1), std::sqrt(1.5), 1e-15);
  EXPECT_EQ(L(0, 1), 0.0);
}

TEST(EigenTemplates, EigenvaluesOfEveryType) {
  expect_eigenvalues(two_by_two_and<MatrixJ>(1));
  expect_eigenvalues(two_by_two_and<Matrix6>(4));
  expect_eigenvalues(two_by_two_and<Eigen::Matrix3d>(1));
  expect_eigenvalues(two_by_two_and<Eigen::MatrixXd>(0));
}

TEST(EigenTemplates, CholeskyOfEveryType) {
  expect_factor(two_by_two_and<MatrixJ>(1));
  expect_factor(two_by_two_and<Matrix6>(4));
  expect_factor(two_by_two_and<Eigen::MatrixXd>(0));
}

}  // namespace
}  // namespace limber::test_eigen_templates
