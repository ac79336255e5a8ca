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

void LugreFriction::begin_step(double v, double h) noexcept {
  if (!has_bristle()) return;
  // G is taken at the start of the step: its negative slope (Stribeck) is slow against a step and
  // must not enter the implicit part, where it would be negative damping.
  const double ratio = v / stribeck_;
  const double level = coulomb_ + (static_ - coulomb_) * std::exp(-ratio * ratio);
  h_ = h;
  decay_per_speed_ = h * sigma0_ / level;
  sigma1_loss_per_speed_ = sigma1_ / (4.0 * level);
}

LugreFriction::Coefficients LugreFriction::coefficients(double v_guess) const noexcept {
  const double speed = std::abs(v_guess);
  return {1.0 + decay_per_speed_ * speed, sigma1_ / (1.0 + sigma1_loss_per_speed_ * speed)};
}

AffineForce LugreFriction::step_force(double v_guess) const noexcept {
  if (!has_bristle()) return {0.0, viscous_};
  const auto [decay, sigma1] = coefficients(v_guess);
  // F = sigma0 z_end + sigma1 (z_end - z) / h + d v_end   with   z_end = (z + h v_end) / decay
  const double gain = (sigma0_ + sigma1 / h_) / decay;
  return {gain * z_ - sigma1 / h_ * z_, gain * h_ + viscous_};
}

double LugreFriction::finish_step(double v_guess, double v_end) noexcept {
  if (!has_bristle()) return viscous_ * v_end;
  const auto [decay, sigma1] = coefficients(v_guess);
  const double z_end = (z_ + h_ * v_end) / decay;
  const double force = sigma0_ * z_end + sigma1 * (z_end - z_) / h_ + viscous_ * v_end;
  z_ = z_end;
  return force;
}

}  // namespace limber::sim
