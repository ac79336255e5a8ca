#include "drivers/drive/fallback.h"

#include <algorithm>
#include <cmath>

namespace limber {

JointCommand Fallback::hold(const JointLink& link, bool settling, KnownMotion known) noexcept {
  const JointConfig& joint = link.joint();
  const double limit = joint.torque_limit_Nm;
  JointCommand command{link.theta(), 0.0, 0.0, 0.0};
  const bool holds = !settling && known.angle;
  if (holds) {
    const double kp = joint.drive.hold_kp_Nm_per_rad;
    if (!holding_) theta_hold_ = link.theta();
    if (kp > 0.0) {
      const double reach = std::max(limit - std::abs(held_), 0.0) / kp;
      theta_hold_ = std::clamp(theta_hold_, link.theta() - reach, link.theta() + reach);
    }
    command.theta = theta_hold_;
    command.kp = kp;
  }
  holding_ = holds;

  const double spring = command.kp * (command.theta - link.theta());
  const auto allowed = [&](double torque) {
    const double near = std::clamp(torque, damped_ - torque_step_, damped_ + torque_step_);
    return std::clamp(near, -limit - spring, limit - spring);
  };
  if (known.velocity) {  // damping comes first
    const double speed = link.theta_dot();
    const double kd = joint.drive.hold_kd_Nms_per_rad;
    const double wanted = held_ - kd * speed;
    const double possible = allowed(wanted);
    command.kd = possible == wanted ? kd : std::clamp((held_ - possible) / speed, 0.0, kd);
  }
  const double damping = -command.kd * link.theta_dot();
  const double step = std::clamp(held_in_the_end_ - held_, -torque_step_, torque_step_);
  const double rest = allowed(held_ + step + damping) - (held_ + damping);
  held_ += std::clamp(rest, std::min(step, 0.0), std::max(step, 0.0));
  damped_ = held_ + damping;
  command.tau = held_;
  return command;
}

}  // namespace limber
