// Rotation vectors: exponential, logarithm and the matrices that relate their rates to angular
// velocity (Sola, Deray, Atchuthan: A micro Lie theory for state estimation in robotics, 2018).
// Every function may be called in the cycle.
#pragma once

#include <Eigen/Geometry>

#pragma GCC visibility push(default)
namespace limber::controller {

/// [a]x, so that [a]x b = a x b.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) noexcept;

/// The rotation by |phi| rad about phi.
Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& phi) noexcept;

/// The shortest rotation vector of a unit quaternion: |result| <= pi. Q and -Q give the same; at
/// exactly pi both axes are right and one of them is returned. Exact to rounding near 0 and pi.
Eigen::Vector3d log_rotation(const Eigen::Quaterniond& Q) noexcept;

/// J_l: with R = Exp(phi) R0 and R0 fixed, omega = J_l(phi) d(phi)/dt. Singular at |phi| = 2 pi.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& phi) noexcept;

/// J_l(phi)^-1 = I - [phi]x/2 + (1 - (|phi|/2) cot(|phi|/2)) / |phi|^2 [phi]x^2, for |phi| < 2 pi.
Eigen::Matrix3d left_jacobian_inverse(const Eigen::Vector3d& phi) noexcept;

/// dJ_l/dt along phi_dot.
Eigen::Matrix3d left_jacobian_rate(const Eigen::Vector3d& phi,
                                   const Eigen::Vector3d& phi_dot) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
