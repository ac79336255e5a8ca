#include "drivers/gate/torque_gate.h"

#include <algorithm>
#include <cmath>
#include <limber/driver_status_t.hpp>

namespace limber {
namespace {

struct CheckInput {
  const GateLimits& limits;
  const GateMemory& memory;
  const GateSituation& situation;
  const joint_command_t& command;
};

template <typename Test>
bool every_joint(const CheckInput& in, Test test) noexcept {
  for (int i = 0; i < in.limits.n; ++i) {
    if (!test(i)) return false;
  }
  return true;
}

bool size_fits(const CheckInput& in) noexcept {
  return in.command.num_joints == in.limits.n - in.limits.hand && in.limits.n <= kMaxJoints;
}

bool session_is_ours(const CheckInput& in) noexcept {
  return in.command.session == in.limits.session;
}

bool controller_holds_lease(const CheckInput& in) noexcept {
  const std::int64_t holder = in.memory.controller;
  return in.command.controller != 0 && (holder == 0 || in.command.controller == holder);
}

bool answers_newer_state(const CheckInput& in) noexcept {
  return in.command.state_seq > in.memory.state_seq;
}

bool answers_recent_state(const CheckInput& in) noexcept {
  const std::int64_t seq = in.command.state_seq;  // not negative: newer than -1 at least
  return seq <= in.situation.state_seq && in.situation.state_seq - seq <= kOldestAnswer;
}

bool all_finite(const CheckInput& in) noexcept {
  return every_joint(in, [&](int i) {
    return std::isfinite(in.command.tau[i]) && std::isfinite(in.command.tau_preload[i]) &&
           std::isfinite(in.command.tau_gravity[i]);
  });
}

bool request_known(const CheckInput& in) noexcept {
  return in.command.request >= joint_command_t::REQUEST_KEEP &&
         in.command.request <= joint_command_t::REQUEST_ACKNOWLEDGE;
}

bool request_possible(const CheckInput& in) noexcept {
  return in.situation.powered || in.command.request != joint_command_t::REQUEST_HOLD;
}

/// Each of two motors makes half of tau_preload and, with one sign or the other, half of tau.
bool preload_within_limits(const CheckInput& in, int i) noexcept {
  const double preload = in.command.tau_preload[i];
  const double limit = in.limits.preload_Nm[i];
  return limit > 0.0 ? std::abs(in.command.tau[i]) + std::abs(preload) <= limit : preload == 0.0;
}

bool torque_within_limits(const CheckInput& in) noexcept {
  return every_joint(in, [&](int i) {
    const double limit = in.limits.torque_Nm[i];
    return std::abs(in.command.tau[i]) <= limit && std::abs(in.command.tau_gravity[i]) <= limit &&
           preload_within_limits(in, i);
  });
}

bool torque_step_within_limits(const CheckInput& in) noexcept {
  return !in.situation.followed || every_joint(in, [&](int i) {
    const double step = in.command.tau[i] - in.situation.torque_present[i];
    const double preload_step = in.command.tau_preload[i] - in.situation.preload_present[i];
    return std::abs(step) <= in.limits.torque_step_Nm[i] &&
           std::abs(preload_step) <= in.limits.preload_step_Nm[i];
  });
}

bool gravity_step_within_limits(const CheckInput& in) noexcept {
  if (!in.situation.followed || !in.memory.has_gravity) return true;
  const auto cycles = static_cast<double>(std::max<std::int64_t>(in.memory.silent_cycles, 1));
  return every_joint(in, [&](int i) {
    const double step = in.command.tau_gravity[i] - in.memory.gravity[i];
    return std::abs(step) <= kGravitySteps * cycles * in.limits.torque_step_Nm[i];
  });
}

bool power_within_limit(const CheckInput& in) noexcept {
  double power_W = 0.0;
  for (int i = 0; i < in.limits.n - in.limits.hand; ++i)
    power_W += in.command.tau[i] * in.situation.velocity[i];
  return !in.situation.followed || power_W <= in.limits.power_W;
}

struct Check {
  int verdict;
  bool (*passes)(const CheckInput&) noexcept;
};

// The order is the documented one: sender, state answered, then content.
constexpr Check kChecks[] = {
    {driver_status_t::VERDICT_SIZE, size_fits},
    {driver_status_t::VERDICT_SESSION, session_is_ours},
    {driver_status_t::VERDICT_CONTROLLER, controller_holds_lease},
    {driver_status_t::VERDICT_REPLAYED, answers_newer_state},
    {driver_status_t::VERDICT_STALE, answers_recent_state},
    {driver_status_t::VERDICT_NOT_FINITE, all_finite},
    {driver_status_t::VERDICT_REQUEST, request_known},
    {driver_status_t::VERDICT_NOT_ON, request_possible},
    {driver_status_t::VERDICT_TORQUE, torque_within_limits},
    {driver_status_t::VERDICT_RATE, torque_step_within_limits},
    {driver_status_t::VERDICT_RATE, gravity_step_within_limits},
    {driver_status_t::VERDICT_POWER, power_within_limit},
};

}  // namespace

int check_command(const GateLimits& limits, const GateMemory& memory,
                  const GateSituation& situation, const joint_command_t& command) noexcept {
  const CheckInput in{limits, memory, situation, command};
  for (const Check& check : kChecks) {
    if (!check.passes(in)) return check.verdict;
  }
  return driver_status_t::VERDICT_ACCEPTED;
}

void TorqueGate::next_cycle() noexcept {
  ++cycle_;
  if (++memory_.silent_cycles < limits_.lease_cycles) return;
  memory_.controller = 0;
  memory_.has_gravity = false;
}

int TorqueGate::judge(const joint_command_t& command, const GateSituation& situation) noexcept {
  const int verdict = check_command(limits_, memory_, situation, command);
  too_often_ = false;
  if (verdict == driver_status_t::VERDICT_ACCEPTED) {
    memory_ = {command.controller, 0, command.state_seq, true, {}};
    std::copy_n(command.tau_gravity, kMaxJoints, memory_.gravity.begin());
    return verdict;
  }
  const bool from_holder = memory_.controller != 0 && command.session == limits_.session &&
                           command.controller == memory_.controller;
  const bool late =
      verdict == driver_status_t::VERDICT_REPLAYED ||
      (verdict == driver_status_t::VERDICT_STALE && command.state_seq < situation.state_seq);
  if (from_holder && !late) {
    too_often_ = refusals_.add(cycle_, limits_.refusal_cycles);
  }
  return verdict;
}

}  // namespace limber
