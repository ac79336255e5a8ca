#include "controller/output/torque_output.h"

#include <limber/controller_status_t.hpp>

namespace limber::controller {

bool TorqueOutput::shape(VectorJ tau, const VectorJ* preload, const ArmState& state,
                         const ArmTerms& terms, const VectorJ& deflection, double dt_s,
                         std::int32_t* limits) noexcept {
  blend_.advance(dt_s, state.v_reported);
  limits_.lead_out(state.q, state.period_s);
  walls_ = limits_.walls(state, terms.M_total);
  tau += walls_;
  *limits |= limits_.shape(state, terms, walls_, &tau);
  if (!tau.allFinite()) return false;
  if (blend_next_) blend_.start(limits_.previous(), tau);
  blend_next_ = false;
  blend_.add_to(&tau);
  if (blend_.active()) *limits |= controller_status_t::LIMIT_RAMP;
  const bool relieved = relief_.apply(terms.g, &tau);
  const std::int32_t clamped = limits_.clamp(state, terms, &tau);
  if (springs_) relief_.note((clamped & controller_status_t::LIMIT_RATE) != 0, state.period_s);
  *limits |= clamped | (relieved ? controller_status_t::LIMIT_RATE : 0);
  const VectorJ& wanted = preload != nullptr ? *preload : preload_.preload_at_rest();
  *limits |= preload_.control(state, wanted, deflection, tau, dt_s);
  return true;
}

void TorqueOutput::stand_by(VectorJ target, const Standby& how, const ArmState& state,
                            std::int32_t* limits) noexcept {
  walls_.setZero();
  relief_.reset();
  limits_.rest(state.q);
  preload_.rest(state, how.preload, how.in_steps);
  if (how.in_steps) {
    *limits |= limits_.clamp(state.period_s, &target);
  } else {
    limits_.set_previous(target);
  }
}

}  // namespace limber::controller
