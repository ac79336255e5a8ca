#include "controller/gains/gain_ramp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber::controller {

void GainRamp::start(const Gains& gains, double duration_s) noexcept {
  const LawSettings before = now_.settings;
  from_ = now_;
  now_.settings = gains.settings;
  now_.M_x = gains.M_x;
  if (before.damping != DampingDesign::kGiven) now_.D_x = gains.D_x;
  if (before.joint_damping != DampingDesign::kGiven) now_.D_q = gains.D_q;
  now_.parameters = gains.parameters;
  now_.parameters.mix(0.0, from_.parameters, gains.parameters);
  from_ = now_;
  to_ = gains;
  elapsed_s_ = 0.0;
  duration_s_ = std::max(duration_s, kShortestRamp_s);
}

void GainRamp::advance(double dt_s) noexcept {
  if (!moving()) return;
  elapsed_s_ += dt_s;
  if (!moving()) {
    now_ = to_;
    return;
  }
  const double s = 0.5 - 0.5 * std::cos(std::numbers::pi * elapsed_s_ / duration_s_);
  const auto mix = [this, s](auto Gains::*part) {
    now_.*part = (1.0 - s) * (from_.*part) + s * (to_.*part);
  };
  for (auto part : {&Gains::K_x, &Gains::D_x}) mix(part);
  for (auto part : {&Gains::damping_ratio, &Gains::joint_damping_ratio}) mix(part);
  for (auto part : {&Gains::K_q, &Gains::D_q, &Gains::K_null, &Gains::D_null}) mix(part);
  now_.parameters.mix(s, from_.parameters, to_.parameters);
}

}  // namespace limber::controller
