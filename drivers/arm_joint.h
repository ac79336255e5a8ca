// One joint of the arm: its drive, or the two drives that pull against each other, seen as one.
//
//   equilibrium e = (theta_1 - theta_2) / 2      tau         = tau_1 - tau_2
//   preload     c = (theta_1 + theta_2) / 2      tau_preload = tau_1 + tau_2
//
// so that tau e' + tau_preload c' is the power of both. The joint is as bad as the worse of its
// motors. Allowed inside the cycle: everything but the constructor.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limber/driver_status_t.hpp>
#include <limber/joint_state_t.hpp>
#include <vector>

#include "drivers/drive/drive.h"
#include "robots/loader/robot.h"

namespace limber {

/// N m; `preload` is zero for joints with one motor.
struct JointTorque {
  double tau = 0.0;
  double preload = 0.0;
};

/// What each of two motors adds to it.
inline double first_share(const JointTorque& torque) noexcept {
  return 0.5 * (torque.preload + torque.tau);
}
inline double second_share(const JointTorque& torque) noexcept {
  return 0.5 * (torque.preload - torque.tau);
}

class ArmJoint {
 public:
  ArmJoint(const Robot& robot, const JointConfig& joint, int bridged_cycles);

  // --- towards the motors ---------------------------------------------------------------------

  std::vector<Drive>& motors() noexcept { return motors_; }
  const std::vector<Drive>& motors() const noexcept { return motors_; }
  /// The part of a torque that motor 0 or 1 makes.
  double share(const JointTorque& torque, std::size_t motor) const noexcept;
  /// The arm's state changed. In FALLBACK the motors go from the torque `present` to `held`.
  void enter(DriveState state, const JointTorque& present, const JointTorque& held) noexcept;
  /// `time_s`: arm time of the cycle.
  void close_cycle(DriveState state, std::int64_t cycle, double time_s) noexcept;
  /// The operator has acknowledged the fault: the watchdogs start afresh.
  void acknowledge() noexcept;

  // --- measured -------------------------------------------------------------------------------

  double q() const noexcept;             ///< rad; without link encoder the motor's, of two motors e
  double v() const noexcept;             ///< rad/s
  double theta() const noexcept;         ///< rad; of two motors e
  double theta_dot() const noexcept;     ///< rad/s
  double preload() const noexcept;       ///< rad; 0 for one motor
  double preload_dot() const noexcept;   ///< rad/s
  double tau() const noexcept;           ///< N m, on the link if there is a torque sensor
  JointTorque applied() const noexcept;  ///< what the drives made of the last command

  bool answered() const noexcept { return std::ranges::all_of(motors_, &Drive::answered); }
  bool configured() const noexcept { return std::ranges::all_of(motors_, &Drive::configured); }
  bool configuration_wrong() const noexcept {
    return std::ranges::any_of(motors_, &Drive::configuration_wrong);
  }
  bool enabling_done() const noexcept {
    return std::ranges::all_of(motors_, &Drive::enabling_done);
  }
  bool enabled() const noexcept { return std::ranges::all_of(motors_, &Drive::enabled); }
  bool disabled() const noexcept { return std::ranges::none_of(motors_, &Drive::enabled); }
  bool lost() const noexcept { return std::ranges::any_of(motors_, &Drive::lost); }
  bool often_invalid() const noexcept {
    return std::ranges::any_of(motors_, &Drive::often_invalid);
  }
  bool failed() const noexcept { return std::ranges::any_of(motors_, &Drive::failed); }
  bool ignores_target() const noexcept {
    return std::ranges::any_of(motors_, &Drive::ignores_target);
  }
  bool setting_changed() const noexcept {
    return std::ranges::any_of(motors_, &Drive::setting_changed);
  }
  bool too_hot() const noexcept { return std::ranges::any_of(motors_, &Drive::too_hot); }
  /// Of the warmest motor.
  double temperature_degC() const noexcept {
    return std::max(first().temperature_degC(), second().temperature_degC());
  }
  /// The first that one of its motors has.
  Contradiction contradiction() const noexcept;
  /// Cycles since all of its motors last replied.
  std::int64_t missing_cycles() const noexcept {
    return std::max(motors_.front().missing_cycles(), motors_.back().missing_cycles());
  }
  /// Cycles since one of its motors last replied.
  std::int64_t silent_cycles() const noexcept;
  /// kBeyondTravel beyond a position limit, or not known to a whole turn; of two motors each also
  /// beyond what it may wind up.
  bool out_of_range() const noexcept;
  /// Above 110 % of the velocity limit in three cycles in a row.
  bool too_fast() const noexcept { return fast_cycles_ >= 3; }
  /// Fit to be moved: answered, enabled and following, within its position limits, not too fast,
  /// not too hot, its settings as they were, and nothing that it reports contradicts the rest.
  bool healthy() const noexcept {
    return ready_to_enable() && enabled() && !ignores_target() && !setting_changed() &&
           contradiction() == Contradiction::kNone;
  }
  /// The same but for being enabled.
  bool ready_to_enable() const noexcept;

  // --- messages: the fields of joint i ---------------------------------------------------------

  void write_state(std::size_t i, joint_state_t* state) const noexcept;
  void write_status(std::size_t i, driver_status_t* status) const noexcept;

 private:
  std::int32_t age_cycles() const noexcept;
  std::int32_t flags() const noexcept;
  bool two_motors() const noexcept { return motors_.size() == 2; }
  bool fresh() const noexcept {
    return age_cycles() == 0 && std::ranges::all_of(motors_, &Drive::credible);
  }
  const JointLink& first() const noexcept { return motors_.front().link(); }
  const JointLink& second() const noexcept { return motors_.back().link(); }

  JointConfig joint_;
  std::vector<Drive> motors_;  ///< one or two
  std::int64_t fast_cycles_ = 0;
};

}  // namespace limber
