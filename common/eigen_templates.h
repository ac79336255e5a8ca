// Eigen's largest templates, compiled once in eigen_templates.cc and only declared everywhere else:
// each takes as long to compile as several files of limber.
//
// They serve decompositions of a plain matrix of these types. One of an expression, such as
// `SelfAdjointEigenSolver<Matrix6>(0.5 * (K + K.transpose()))`, is compiled on the spot: put the
// expression into a matrix first.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "common/types.h"

namespace Eigen {

#define LIMBER_EIGENVALUES(EXTERN, MATRIX)                                                         \
  EXTERN template SelfAdjointEigenSolver<MATRIX>& SelfAdjointEigenSolver<MATRIX>::compute<MATRIX>( \
      const EigenBase<MATRIX>&, int);
#define LIMBER_CHOLESKY(EXTERN, MATRIX) \
  EXTERN template LLT<MATRIX>& LLT<MATRIX>::compute<MATRIX>(const EigenBase<MATRIX>&);
#define LIMBER_EIGEN_TEMPLATES(EXTERN)        \
  LIMBER_EIGENVALUES(EXTERN, limber::MatrixJ) \
  LIMBER_EIGENVALUES(EXTERN, limber::Matrix6) \
  LIMBER_EIGENVALUES(EXTERN, Matrix3d)        \
  LIMBER_EIGENVALUES(EXTERN, MatrixXd)        \
  LIMBER_CHOLESKY(EXTERN, limber::MatrixJ)    \
  LIMBER_CHOLESKY(EXTERN, limber::Matrix6)    \
  LIMBER_CHOLESKY(EXTERN, MatrixXd)

LIMBER_EIGEN_TEMPLATES(extern)

}  // namespace Eigen
