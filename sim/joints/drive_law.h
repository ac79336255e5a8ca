// The torque law a motor follows between two frames on the bus, in its joint's coordinates; q, v
// are the motor's own.
#pragma once

#include <algorithm>

namespace limber::sim {

/// tau = kp (q_des - q) + kd (v_des - v) + tau_ff, held within +-limit. All zero: phases open.
struct DriveLaw {
  double kp = 0.0;
  double kd = 0.0;
  double q_des = 0.0;
  double v_des = 0.0;
  double tau_ff = 0.0;
  double limit = 0.0;
  /// Phases shorted: a passive damper, N m s/rad; not limited, since no current controller is at
  /// work.
  double passive_damping = 0.0;

  double torque(double q, double v) const noexcept {
    return std::clamp(kp * (q_des - q) + kd * (v_des - v) + tau_ff, -limit, limit);
  }
};

}  // namespace limber::sim
