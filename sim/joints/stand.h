// The bench under an arm without brakes: it carries the arm at its start pose until the drives hold
// it, and is then taken away.
#pragma once

#include <algorithm>
#include <cstdint>

#include "robots/loader/robot.h"
#include "sim/joints/friction.h"

namespace limber::sim {

/// How much of the stand is left, 1 to 0. It goes away over kFade_ns once every drive has been
/// enabled for kSettle_ns, and does not come back.
class StandFade {
 public:
  static constexpr std::int64_t kSettle_ns = 300'000'000;
  static constexpr std::int64_t kFade_ns = 300'000'000;

  double left(std::int64_t now_ns, bool all_enabled) noexcept {
    if (!all_enabled && !leaving_) enabled_since_ns_ = now_ns;
    leaving_ = leaving_ || now_ns - enabled_since_ns_ >= kSettle_ns;
    if (!leaving_) return 1.0;
    const auto gone = static_cast<double>(now_ns - enabled_since_ns_ - kSettle_ns);
    return std::clamp(1.0 - gone / static_cast<double>(kFade_ns), 0.0, 1.0);
  }

 private:
  std::int64_t enabled_since_ns_ = 0;
  bool leaving_ = false;
};

/// One joint of the arm in the stand, or one of its motors: F = left * (k (q - q_start) + d v), k
/// such that the joint's torque limit moves it by 2 mrad (2 mm on a prismatic joint), d = k * 10
/// ms.
class Stand {
 public:
  Stand() = default;
  Stand(const JointConfig& joint, double q_start)
      : q_start_(q_start), stiffness_(joint.torque_limit_Nm / kGive) {}

  void set_left(double left) noexcept { left_ = left; }
  bool holds() const noexcept { return left_ * stiffness_ > 0.0; }

  /// As an implicit step wants it: the force opposing positive motion.
  AffineForce step_force(double q, double h) const noexcept {
    const double k = left_ * stiffness_;
    return {k * (q - q_start_), k * (h + kTimeConstant_s)};
  }

  /// Torque on the joint over a step that starts at q and ends at speed v_end.
  double torque(double q, double v_end, double h) const noexcept {
    const AffineForce force = step_force(q, h);
    return -(force.offset + force.slope * v_end);
  }

 private:
  static constexpr double kGive = 0.002;
  static constexpr double kTimeConstant_s = 0.01;

  double q_start_ = 0.0;
  double stiffness_ = 0.0;
  double left_ = 0.0;
};

}  // namespace limber::sim
