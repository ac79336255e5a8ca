#include "drivers/fallback.h"

#include <algorithm>
#include <cmath>

namespace limber {

JointCommand JointHold::command(const JointLink& link, bool settling, bool trusted) noexcept {
  const JointConfig& joint = link.joint();
  const double kp = joint.drive.hold_kp_Nm_per_rad;
  const double kd = joint.drive.hold_kd_Nms_per_rad;
  if (settling || !trusted) {
    holding_ = false;
    return {link.q(), 0.0, kd, gravity_};
  }
  if (!holding_) q_hold_ = link.q();
  holding_ = true;
  if (kp > 0.0) {
    const double reach = std::max(joint.torque_limit_Nm - std::abs(gravity_), 0.0) / kp;
    q_hold_ = std::clamp(q_hold_, link.q() - reach, link.q() + reach);
  }
  return {q_hold_, kp, kd, gravity_};
}

}  // namespace limber
