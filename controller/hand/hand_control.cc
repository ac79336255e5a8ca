#include "controller/hand/hand_control.h"

#include <algorithm>
#include <cmath>

#include "controller/kinds/within.h"

namespace limber::controller {
namespace {

// Steps of the torque that tau_gravity may make in a cycle; the gate lets three pass.
constexpr double kGravitySteps = 2.0;

}  // namespace

HandControl::HandControl(const Robot& robot, std::int64_t controller)
    : hand_(robot.hand.value()),
      index_(robot.joints.size()),
      law_(hand_),
      gravity_rate_(kGravitySteps * hand_.drive.torque_rate_limit_Nm_per_s) {
  state_.controller = controller;
  state_.max_width_m = hand_.travel.open_m();
}

Refusal HandControl::check(const hand_goal_t& goal) const noexcept {
  if (!(std::isfinite(goal.width_m) && std::isfinite(goal.force_N) &&
        std::isfinite(goal.speed_m_per_s)))
    return malformed("the goal of the hand is not finite");
  const auto beyond = [](const char* reason) {
    return Refusal{request_answer_t::REFUSED_HAND_LIMIT, reason};
  };
  if (!within(goal.width_m, -HandLaw::kPress_m, hand_.travel.open_m()))
    return beyond("width_m must be within -0.02 and the greatest of the travel table");
  if (!within(goal.force_N, 0.0, hand_.force_limit_N))
    return beyond("force_N must be within 0 and force_limit_N of robot.yaml");
  if (!within(goal.speed_m_per_s, 0.0, hand_.speed_limit_m_per_s))
    return beyond("speed_m_per_s must be within 0 and speed_limit_m_per_s of robot.yaml");
  return {};
}

double HandControl::within_travel(double width_m) const noexcept {
  constexpr double kWidthRounding_m = 1e-3;
  const double nearest = std::clamp(width_m, -HandLaw::kPress_m, hand_.travel.open_m());
  return std::abs(nearest - width_m) <= kWidthRounding_m ? nearest : width_m;
}

void HandControl::set_goal(const hand_goal_t& goal) noexcept {
  law_.set_goal({goal.width_m, goal.force_N > 0.0 ? goal.force_N : hand_.force_limit_N,
                 goal.speed_m_per_s > 0.0 ? goal.speed_m_per_s : hand_.speed_limit_m_per_s});
}

void HandControl::measure(const joint_state_t& state) noexcept {
  at_ = {state.q[index_], state.v[index_]};
  applied_Nm_ = state.tau_applied[index_];
  const double slope = hand_.travel.slope(at_.angle_rad);
  state_.width_m = hand_.travel.width(at_.angle_rad);
  state_.speed_m_per_s = slope * at_.rate_rad_per_s;
  state_.force_N = -state.tau[index_] / slope;
  state_.temperature_degC = state.temperature_degC[index_];
}

void HandControl::step(bool follow, double dt_s) noexcept {
  if (!engaged_) law_.begin(at_, applied_Nm_);
  if (!follow) law_.stay();
  engaged_ = true;
  torque_ = law_.step(at_, dt_s);
  keep(torque_, dt_s);
}

void HandControl::stand_by(Rest rest, double dt_s) noexcept {
  engaged_ = false;
  law_.rest(at_, applied_Nm_, dt_s);
  if (rest == Rest::kNone) keep(0.0, dt_s);
  torque_ = rest == Rest::kNone ? 0.0 : rest == Rest::kApplied ? applied_Nm_ : kept_;
}

void HandControl::keep(double torque, double dt_s) noexcept {
  const double goal = std::clamp(torque, -hand_.rated_torque_Nm, hand_.rated_torque_Nm);
  kept_ = std::clamp(goal, kept_ - gravity_rate_ * dt_s, kept_ + gravity_rate_ * dt_s);
}

void HandControl::write(joint_command_t* command) const noexcept {
  command->tau[index_] = torque_;
  command->tau_gravity[index_] = kept_;
}

void HandControl::write_state(std::int64_t seq, std::int64_t time_ns) noexcept {
  state_.seq = seq;
  state_.time_ns = time_ns;
  const double open_m = hand_.travel.open_m() - hand_.travel.closed_m();
  state_.opening = std::clamp((state_.width_m - hand_.travel.closed_m()) / open_m, 0.0, 1.0);
  state_.force_bound_N = law_.bound_N();
  state_.heat = law_.heat().heat();
  state_.goal_width_m = law_.goal().width_m;
  state_.goal_force_N = law_.goal().force_N;
  state_.goal_speed_m_per_s = law_.goal().speed_m_per_s;
  state_.target_m = law_.target_m();
  state_.grasped = engaged_ && law_.grasped() ? 1 : 0;
  state_.moving = law_.moving() ? 1 : 0;
  state_.warm = law_.heat().warm() ? 1 : 0;
  state_.engaged = engaged_ ? 1 : 0;
}

}  // namespace limber::controller
