#include "drivers/drive/fallback.h"

#include <algorithm>
#include <cmath>

namespace limber {

JointCommand Fallback::command(const JointLink& link, bool settling, bool trusted) noexcept {
  const JointConfig& joint = link.joint();
  const double kp = joint.drive.hold_kp_Nm_per_rad;
  const double kd = joint.drive.hold_kd_Nms_per_rad;
  held_ += std::clamp(held_in_the_end_ - held_, -torque_step_, torque_step_);
  if (settling || !trusted) {
    holding_ = false;
    return {link.theta(), 0.0, kd, held_};
  }
  if (!holding_) theta_hold_ = link.theta();
  holding_ = true;
  if (kp > 0.0) {
    const double reach = std::max(joint.torque_limit_Nm - std::abs(held_), 0.0) / kp;
    theta_hold_ = std::clamp(theta_hold_, link.theta() - reach, link.theta() + reach);
  }
  return {theta_hold_, kp, kd, held_};
}

}  // namespace limber
