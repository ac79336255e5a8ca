// The last check before the bus: may this torque command of this controller reach the drives?
//
// Deny by default. A command passes all checks or changes nothing: it is never clamped into what is
// allowed, and it leaves no trace in what the next one is compared with. Every comparison is
// written so that a NaN fails it. No heap, no Eigen, no URDF, no log; all of it is allowed inside
// the cycle.
#pragma once

#include <array>
#include <cstdint>
#include <limber/joint_command_t.hpp>
#include <limits>

#include "common/joints.h"
#include "drivers/gate/event_window.h"

#pragma GCC visibility push(default)
namespace limber {

/// Limits of accepted commands. Fixed for a session.
struct GateLimits {
  int n = 0;                 ///< joints of this arm, and its hand
  int hand = 0;              ///< 1: the last of them is the hand, which num_joints leaves out
  std::int64_t session = 0;  ///< this run of the driver
  int lease_cycles =
      250;  ///< the lease of a controller ends after so long without an accepted command
  int refusal_cycles = 100;  ///< three refusals within so many cycles are too many
  std::array<double, kMaxJoints> torque_Nm{};       ///< greatest |tau| and |tau_gravity|
  std::array<double, kMaxJoints> torque_step_Nm{};  ///< greatest |tau - torque present|
  /// Greatest |tau| + |tau_preload|, twice what each of two motors may; 0: one motor, no preload.
  std::array<double, kMaxJoints> preload_Nm{};
  std::array<double, kMaxJoints> preload_step_Nm{};          ///< greatest |tau_preload - present|
  double power_W = std::numeric_limits<double>::infinity();  ///< greatest sum of tau v, joints
};

/// State of the driver when a command arrives.
struct GateSituation {
  std::int64_t state_seq = 0;  ///< seq of the JOINT_STATE last published
  bool powered = false;        ///< some drive may be enabled: there is something to hold
  /// The torque would reach the drives. Otherwise it is judged for being finite and within the
  /// absolute limits, but not against the torque present, and goes nowhere.
  bool followed = false;
  std::array<double, kMaxJoints> torque_present{};   ///< what left for the drives last, N m
  std::array<double, kMaxJoints> preload_present{};  ///< likewise of tau_preload
  std::array<double, kMaxJoints> velocity{};         ///< as reported last, rad/s or m/s
};

/// What the gate remembers of the commands it accepted.
struct GateMemory {
  std::int64_t controller = 0;  ///< number of the lease's holder; 0: none
  std::int64_t silent_cycles = 0;
  std::int64_t state_seq = -1;  ///< the state answered by the command accepted last
  bool has_gravity = false;     ///< of a command that this controller was accepted with
  std::array<double, kMaxJoints> gravity{};  ///< its tau_gravity, N m
};

/// An answer may refer to a state this many cycles old.
inline constexpr std::int64_t kOldestAnswer = 5;

/// The weight of a moving arm changes by less than a step of the torque in a cycle; a switch of the
/// position at which it is evaluated adds to that.
inline constexpr double kGravitySteps = 3.0;

/// The judgement alone, without effect: VERDICT_* of driver_status_t. The checks are made in this
/// order and the first that fails names the verdict:
///   SIZE        num_joints is this arm's
///   SESSION     the session is this run of the driver
///   CONTROLLER  not 0, and the holder of the lease if there is one
///   REPLAYED    answers a newer state than the command accepted last
///   STALE       answers a state that was published, at most kOldestAnswer cycles ago
///   NOT_FINITE  all of tau, tau_preload and tau_gravity
///   REQUEST     one of REQUEST_*
///   NOT_ON      no REQUEST_HOLD to drives that are off: they cannot hold
///   TORQUE      |tau| and |tau_gravity| within the limit, |tau| + |tau_preload| within that of two
///               motors; no tau_preload for one
///   RATE        tau and tau_preload within their steps of what is present, tau_gravity within
///               kGravitySteps of those a cycle of the last one accepted, where the torque is
///               followed
///   POWER       sum of tau v within the limit, where the torque is followed
int check_command(const GateLimits& limits, const GateMemory& memory,
                  const GateSituation& situation, const joint_command_t& command) noexcept;

/// The judgement with memory: lease, sequence, refusals.
class TorqueGate {
 public:
  explicit TorqueGate(const GateLimits& limits) : limits_(limits) {}

  /// Once a cycle: the lease ages and is free after lease_cycles without an accepted command.
  void next_cycle() noexcept;

  /// Returns VERDICT_*. An accepted command takes or renews the lease.
  int judge(const joint_command_t& command, const GateSituation& situation) noexcept;

  /// True if the command judged last was the third of the lease holder's to be refused within
  /// refusal_cycles. Repetitions of an accepted command (REPLAYED) do not count, since networks
  /// duplicate, nor do answers to states that are too old: they are missing, which has its own
  /// watchdog (ControllerWatch).
  bool refused_too_often() const noexcept { return too_often_; }

  /// Some controller holds the lease.
  bool leased() const noexcept { return memory_.controller != 0; }
  const GateMemory& memory() const noexcept { return memory_; }

 private:
  GateLimits limits_;
  GateMemory memory_;
  EventWindow<3> refusals_;
  std::int64_t cycle_ = 0;
  bool too_often_ = false;
};

}  // namespace limber
#pragma GCC visibility pop
