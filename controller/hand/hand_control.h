// The hand in the controller's cycle: from JOINT_STATE and HAND_GOAL to its torque and HAND_STATE.
//
// Its law runs while the torques reach the motors. In HOLD and SOFT_STOP it keeps what it holds,
// and stops where it moves. Where the driver holds by itself it is left to make what the hand made
// last, at most the rated torque (tau_gravity).
#pragma once

#include <cstdint>
#include <limber/hand_goal_t.hpp>
#include <limber/hand_state_t.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>

#include "controller/hand/hand_law.h"
#include "controller/kinds/refusal.h"

namespace limber::controller {

/// Every member but the constructor is allowed in the cycle.
class HandControl {
 public:
  /// The robot has a hand.
  HandControl(const Robot& robot, std::int64_t controller);

  /// Nothing: a goal that the hand can follow; else why not.
  Refusal check(const hand_goal_t& goal) const noexcept;
  /// Of a goal that was checked, with robot.yaml's limits where it leaves them open.
  void set_goal(const hand_goal_t& goal) noexcept;
  /// Of a target stream, which is as exact as 32 bits are: `width_m` within the travel, if it is a
  /// rounding away from it; else as it is, for check().
  double within_travel(double width_m) const noexcept;
  HandLaw& law() noexcept { return law_; }

  /// A state that has been judged usable.
  void measure(const joint_state_t& state) noexcept;
  /// One cycle of the law, `dt_s` after the last; with `follow` false it stays where it is.
  void step(bool follow, double dt_s) noexcept;
  /// One cycle without: the torque that the drive applied, what it keeps, or none.
  enum class Rest : std::uint8_t { kNone, kApplied, kKept };
  void stand_by(Rest rest, double dt_s) noexcept;

  /// The hand's entry of the arrays.
  void write(joint_command_t* command) const noexcept;
  /// After write(); `seq`, `time_ns`: of CONTROLLER_STATUS.
  void write_state(std::int64_t seq, std::int64_t time_ns) noexcept;
  const hand_state_t& state() const noexcept { return state_; }

 private:
  void keep(double torque, double dt_s) noexcept;

  HandConfig hand_;
  std::size_t index_;
  HandLaw law_;
  HandReading at_;
  double applied_Nm_ = 0.0;
  double torque_ = 0.0;
  double kept_ = 0.0;
  double gravity_rate_;
  bool engaged_ = false;
  hand_state_t state_{};
};

}  // namespace limber::controller
