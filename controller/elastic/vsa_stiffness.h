// The joint stiffnesses that come nearest to a Cartesian stiffness.
#pragma once

#include "common/types.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// m x n, m <= 6 task rows.
using TaskJacobian =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxJoints>;
using TaskMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

/// A joint stiffness can only be diagonal, so most Cartesian ones are missed (Albu-Schaeffer,
/// Fischer, Schreiber, Schoeppe, Hirzinger, IROS 2004).
struct JointFit {
  VectorJ value;    ///< n
  double residual;  ///< what is missed, as a share of what was asked (Frobenius norms)
};

/// Diagonal of K_q = J^T K_x J + K_G, N m/rad, the nearest diagonal matrix; residual
/// |off-diagonal| / |K_q|. K_x: m x m, N/m; K_G: geometric stiffness of the load, n x n, zero if
/// there is none. May be called in the cycle.
JointFit nearest_joint_stiffness(const TaskJacobian& J, const TaskMatrix& K_x,
                                 const MatrixJ& K_G) noexcept;

/// Compliances s >= 0, rad/(N m), that minimise |W (J diag(s) J^T - K_x^-1) W|, W = sqrt(diag K_x),
/// by non-negative least squares; residual: that norm / |W K_x^-1 W|. K_x positive definite. The
/// stiffness to command is 1/s; a joint with s = 0 shall be as stiff as it can. For the slow rate.
JointFit nearest_joint_compliance(const TaskJacobian& J, const TaskMatrix& K_x) noexcept;

/// Compliance of the tip really presented, J (diag(sigma) - K_G)^-1 J^T, m x m, m/N; its inverse is
/// J^-T (diag(sigma) - K_G) J^-1 for square J. May be called in the cycle.
TaskMatrix presented_compliance(const TaskJacobian& J, const VectorJ& sigma,
                                const MatrixJ& K_G) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
