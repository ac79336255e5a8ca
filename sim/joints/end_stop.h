// The mechanical stops of a joint: a stiff one-sided spring and damper at each limit.
#pragma once

#include <algorithm>

#include "robots/loader/robot.h"
#include "sim/joints/friction.h"

namespace limber::sim {

/// Outside the limits F = k * depth + d * (speed inwards), never pulling. k is such that the
/// joint's torque limit presses the stop in by 10 mrad (10 mm on a prismatic joint); d = k * 5 ms.
/// Continuous joints have none.
class EndStop {
 public:
  EndStop() = default;
  explicit EndStop(const JointConfig& joint)
      : low_(joint.position_min),
        high_(joint.position_max),
        stiffness_(joint.torque_limit_Nm / kGive),
        damping_(stiffness_ * kTimeConstant_s) {}

  bool touched(double q) const noexcept { return q > high_ || q < low_; }

  /// As an implicit step wants it: the force opposing positive motion. Nothing within the limits.
  AffineForce step_force(double q, double h) const noexcept {
    const double depth = depth_at(q);
    if (depth == 0.0) return {};
    return {stiffness_ * depth, stiffness_ * h + damping_};
  }

  /// Torque on the joint over a step that starts at q and ends at speed v_end.
  double torque(double q, double v_end, double h) const noexcept {
    const AffineForce force = step_force(q, h);
    const double torque = -(force.offset + force.slope * v_end);
    return depth_at(q) > 0.0 ? std::min(torque, 0.0) : std::max(torque, 0.0);
  }

 private:
  static constexpr double kGive = 0.01;
  static constexpr double kTimeConstant_s = 0.005;

  /// How far beyond a limit, with the sign of the limit's side.
  double depth_at(double q) const noexcept {
    return std::max(q - high_, 0.0) + std::min(q - low_, 0.0);
  }

  double low_ = 0.0;
  double high_ = 0.0;
  double stiffness_ = 0.0;
  double damping_ = 0.0;
};

}  // namespace limber::sim
