// Vectors and matrices of one arm: sized at run time, stored in place, so they never allocate.
#pragma once

#include <Eigen/Core>

#include "common/joints.h"

namespace limber {

using VectorJ = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;
using MatrixJ =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;
/// Six-vectors have the linear part first.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix6J = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxJoints>;
/// By rows: one joint's six numbers lie together, as the columns of Matrix6J do.
using MatrixJ6 = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, kMaxJoints, 6>;

}  // namespace limber
