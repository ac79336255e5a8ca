#include "sim/joints/friction.h"

#include <algorithm>
#include <cmath>

namespace limber::sim {

LugreFriction::LugreFriction(const FrictionConfig& config, double rotor_inertia)
    : coulomb_(config.coulomb_Nm),
      static_(std::max(config.static_Nm, config.coulomb_Nm)),
      stribeck_(config.stribeck_rad_per_s),
      viscous_(config.viscous_Nms_per_rad) {
  if (coulomb_ > 0.0) {
    sigma0_ = coulomb_ / config.bristle_rad;
    sigma1_ = 2.0 * std::sqrt(sigma0_ * rotor_inertia);
  }
}

LugreFriction::Coefficients LugreFriction::coefficients(double v, double v_guess,
                                                        double h) const noexcept {
  // G is taken at the start of the step: its negative slope (Stribeck) is slow against a step and
  // must not enter the implicit part, where it would be negative damping.
  const double ratio = v / stribeck_;
  const double level = coulomb_ + (static_ - coulomb_) * std::exp(-ratio * ratio);
  const double speed = std::abs(v_guess);
  const double sigma1 = sigma1_ > 0.0 ? 1.0 / (1.0 / sigma1_ + speed / (4.0 * level)) : 0.0;
  return {1.0 + h * sigma0_ * speed / level, sigma1};
}

AffineForce LugreFriction::step_force(double v, double v_guess, double h) const noexcept {
  if (!(coulomb_ > 0.0)) return {0.0, viscous_};
  const auto [decay, sigma1] = coefficients(v, v_guess, h);
  // F = sigma0 z_end + sigma1 (z_end - z) / h + d v_end   with   z_end = (z + h v_end) / decay
  const double gain = (sigma0_ + sigma1 / h) / decay;
  return {gain * z_ - sigma1 / h * z_, gain * h + viscous_};
}

double LugreFriction::finish_step(double v, double v_guess, double v_end, double h) noexcept {
  if (!(coulomb_ > 0.0)) return viscous_ * v_end;
  const auto [decay, sigma1] = coefficients(v, v_guess, h);
  const double z_end = (z_ + h * v_end) / decay;
  const double force = sigma0_ * z_end + sigma1 * (z_end - z_) / h + viscous_ * v_end;
  z_ = z_end;
  return force;
}

}  // namespace limber::sim
