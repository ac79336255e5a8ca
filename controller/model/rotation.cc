#include "controller/model/rotation.h"

#include <cmath>

namespace limber::controller {
namespace {

// Below this angle the closed forms lose more digits than the series leave out.
constexpr double kSmallAngle = 1e-2;

// J_l = I + a [phi]x + b [phi]x^2, and the derivatives of a and b by |phi|, divided by |phi|.
struct Coefficients {
  double a;
  double b;
  double a_rate;
  double b_rate;
};

Coefficients coefficients(double angle) noexcept {
  const double x = angle * angle;
  if (angle < kSmallAngle) {
    return {0.5 - x / 24.0 + x * x / 720.0, 1.0 / 6.0 - x / 120.0 + x * x / 5040.0,
            -1.0 / 12.0 + x / 180.0, -1.0 / 60.0 + x / 1260.0};
  }
  const double s = std::sin(angle);
  const double half = std::sin(0.5 * angle);
  const double one_minus_cos = 2.0 * half * half;
  return {one_minus_cos / x, (angle - s) / (x * angle), (angle * s - 2.0 * one_minus_cos) / (x * x),
          (angle * one_minus_cos - 3.0 * (angle - s)) / (x * x * angle)};
}

}  // namespace

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) noexcept {
  Eigen::Matrix3d result;
  result << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return result;
}

Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& phi) noexcept {
  const double angle = phi.norm();
  const double factor = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond Q;
  Q.w() = std::cos(0.5 * angle);
  Q.vec() = factor * phi;
  Q.normalize();
  return Q;
}

Eigen::Vector3d log_rotation(const Eigen::Quaterniond& Q) noexcept {
  const double sign = Q.w() < 0.0 ? -1.0 : 1.0;
  const double w = sign * Q.w();
  const double s = Q.vec().norm();
  // atan2(s, w) / s near s = 0; atan2 keeps all digits near pi, where acos(w) would not.
  const double factor = s < 1e-4 ? (1.0 - s * s / (3.0 * w * w)) / w : std::atan2(s, w) / s;
  return 2.0 * sign * factor * Q.vec();
}

Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& phi) noexcept {
  const Coefficients c = coefficients(phi.norm());
  const Eigen::Matrix3d P = cross_matrix(phi);
  return Eigen::Matrix3d::Identity() + c.a * P + c.b * P * P;
}

Eigen::Matrix3d left_jacobian_inverse(const Eigen::Vector3d& phi) noexcept {
  const double angle = phi.norm();
  const double half = 0.5 * angle;
  const double c = angle < kSmallAngle
                       ? 1.0 / 12.0 + angle * angle / 720.0
                       : (1.0 - half * std::cos(half) / std::sin(half)) / (angle * angle);
  const Eigen::Matrix3d P = cross_matrix(phi);
  return Eigen::Matrix3d::Identity() - 0.5 * P + c * P * P;
}

Eigen::Matrix3d left_jacobian_rate(const Eigen::Vector3d& phi,
                                   const Eigen::Vector3d& phi_dot) noexcept {
  const Coefficients c = coefficients(phi.norm());
  const double growth = phi.dot(phi_dot);  // |phi| d|phi|/dt
  const Eigen::Matrix3d P = cross_matrix(phi);
  const Eigen::Matrix3d P_dot = cross_matrix(phi_dot);
  return c.a_rate * growth * P + c.a * P_dot + c.b_rate * growth * P * P +
         c.b * (P_dot * P + P * P_dot);
}

}  // namespace limber::controller
