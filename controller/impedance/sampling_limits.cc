#include "controller/impedance/sampling_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber::controller {

double stiffness_limit(double damping, double T, double t_d) noexcept {
  return std::max(damping, 0.0) / (0.5 * T + t_d);
}

double passive_stiffness_limit(double b, double B, double T) noexcept {
  return 2.0 * std::max(b - std::abs(B), 0.0) / T;
}

double free_mass_stiffness_limit(double m, double b, double T) noexcept {
  const double a = b / m;
  const double lost = -std::expm1(-a * T);  // 1 - p
  const double denominator = lost - a * T * (1.0 - lost);
  return denominator > 0.0 ? b * a * lost / denominator : 0.0;
}

double damping_limit(double m, double T) noexcept { return 2.0 * m / T; }

double delayed_damping_limit(double m, double T) noexcept {
  return (std::numbers::sqrt2 - 1.0) * damping_limit(m, T);
}

double delay_stiffness_limit(double m, double zeta, double t_d) noexcept {
  const double zeta2 = zeta * zeta;
  const double cosine = std::sqrt(4.0 * zeta2 * zeta2 + 1.0) - 2.0 * zeta2;
  const double x = std::acos(cosine) / t_d;
  return m * x * x * cosine;
}

double quantised_wall_stiffness_limit(double b, double F_c, double delta, double T) noexcept {
  return std::min(2.0 * b / T, 2.0 * F_c / delta);
}

double torque_lag_stiffness_limit(double m, double b, double D, double tau_e) noexcept {
  return std::max(D + b, 0.0) * (1.0 / tau_e + b / m);
}

}  // namespace limber::controller
