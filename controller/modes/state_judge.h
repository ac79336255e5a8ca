// Is this JOINT_STATE new, complete and fit to be acted on?
#pragma once

#include <array>
#include <cstdint>
#include <limber/joint_state_t.hpp>
#include <optional>

#include "common/joints.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// What a joint has, as its flags tell.
using JointFlags = std::array<std::int32_t, kMaxJoints>;
inline constexpr std::int32_t kEquipment =
    int{joint_state_t::JOINT_LINK_ENCODER} | int{joint_state_t::JOINT_TORQUE_SENSOR} |
    int{joint_state_t::JOINT_TWO_MOTORS} | int{joint_state_t::JOINT_HAND};
/// As robot.yaml has it. For set-up.
JointFlags equipment_of(const Robot& robot);

struct StateJudgement {
  bool repeated = false;  ///< its number was seen before in this session: nothing may advance
  bool doubted = false;   ///< another session's first: likewise
  bool ignored() const noexcept { return repeated || doubted; }
  bool first = false;        ///< the first state of all
  bool new_session = false;  ///< another run of the driver, seen twice
  bool usable = false;  ///< this arm's joints, all numbers finite, sensible period, number in reach
  bool fresh = false;   ///< usable, and every joint has answered in this cycle
  std::int64_t missed = 0;  ///< states between the last one and this one
  bool silent = false;  ///< states, or a joint's answers, are missing for longer than is bridged
};

/// Follows the stream by session and number. All members may be called in the cycle.
class StateJudge {
 public:
  /// `joints`: at most kMaxJoints. `flags`: the JOINT_* bits of kEquipment that each joint has; a
  /// state that says otherwise is of another arm. So many cycles in a row without a state, or
  /// without a joint's answer, are bridged.
  /// A hand is judged as a joint after them; `flags` has it.
  StateJudge(int joints, int bridged_cycles, const JointFlags& flags = {})
      : joints_(joints),
        driven_(joints + hands_in(joints, flags)),
        bridged_(bridged_cycles),
        flags_(flags) {}
  StateJudgement judge(const joint_state_t& state) noexcept;
  /// The next state may have any number: nothing new has come for too long.
  void forget_sequence() noexcept { seq_ = -1; }

  std::int64_t received() const noexcept { return received_; }
  std::int64_t lost() const noexcept { return lost_; }
  /// States of sessions of which nothing else was heard.
  std::int64_t doubted() const noexcept { return doubted_; }

  /// A number this much higher than the last one is not believed until the next state goes on from
  /// it: one forged or damaged message must not make all true ones look old.
  static constexpr std::int64_t kMostMissed = 1000;

 private:
  bool goes_on_from_doubted(std::int64_t seq) const noexcept;
  /// Of another session than the last state's. One forged or damaged message is no new driver: that
  /// sends another one, or in lock step the same again.
  bool is_doubtful(const joint_state_t& state) noexcept;

  static int hands_in(int joints, const JointFlags& flags) noexcept {
    return joints < kMaxJoints && flags[static_cast<std::size_t>(joints)] != 0 ? 1 : 0;
  }

  int joints_;
  int driven_;  ///< with the hand
  int bridged_;
  JointFlags flags_;
  std::int64_t session_ = 0;
  std::int64_t seq_ = -1;
  std::optional<std::int64_t> doubted_seq_;
  /// A state of another session.
  struct Other {
    std::int64_t session;
    std::int64_t seq;
  };
  std::optional<Other> other_;  ///< heard of once
  std::int64_t doubted_ = 0;
  std::int64_t received_ = 0;
  std::int64_t lost_ = 0;
};

}  // namespace limber::controller
