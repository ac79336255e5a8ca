// The task of an arm: what its tip can be asked for, as vectors of six or, for an arm of two joints
// in the x-y plane of its base, of two.
#pragma once

#include "common/types.h"
#include "controller/impedance/nullspace.h"

namespace limber::eval {

/// Six-vectors of the laws are [linear; angular]; the task (x, y) is their first two rows, the
/// others are zero.
struct Task {
  bool planar = false;

  Eigen::Index size() const noexcept { return planar ? 2 : 6; }
  Eigen::Index position() const noexcept { return planar ? 2 : 3; }

  Vector6 embed(const Eigen::VectorXd& vector) const {
    Vector6 six = Vector6::Zero();
    six.head(size()) = vector;
    return six;
  }
  Matrix6 embed(const Eigen::MatrixXd& matrix) const {
    Matrix6 six = Matrix6::Zero();
    six.topLeftCorner(size(), size()) = matrix;
    return six;
  }

  Eigen::VectorXd of(const Vector6& six) const { return six.head(size()); }
  Eigen::MatrixXd of(const Matrix6& six) const { return six.topLeftCorner(size(), size()); }
  Eigen::MatrixXd of(const Matrix6J& six) const { return six.topRows(size()); }
  Eigen::MatrixXd of(const MatrixJ6& six) const { return six.leftCols(size()); }

  /// All rows of the task, whatever the stiffness.
  controller::TaskRows rows() const {
    return controller::TaskRows(embed(Eigen::MatrixXd(Eigen::MatrixXd::Identity(size(), size()))));
  }
};

}  // namespace limber::eval
