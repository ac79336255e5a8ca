#include "drivers/gate/torque_gate.h"

#include <cmath>
#include <limber/driver_status_t.hpp>

namespace limber {
namespace {

struct Question {
  const GateLimits& limits;
  const GateMemory& memory;
  const GateSituation& situation;
  const joint_torque_t& command;
};

template <typename Test>
bool every_joint(const Question& ask, Test test) noexcept {
  for (int i = 0; i < ask.limits.n; ++i) {
    if (!test(i)) return false;
  }
  return true;
}

bool size_fits(const Question& ask) noexcept {
  return ask.command.num_joints == ask.limits.n && ask.limits.n <= kMaxJoints;
}

bool session_is_ours(const Question& ask) noexcept {
  return ask.command.session == ask.limits.session;
}

bool controller_may(const Question& ask) noexcept {
  const std::int64_t holder = ask.memory.controller;
  return ask.command.controller != 0 && (holder == 0 || ask.command.controller == holder);
}

bool answers_newer_state(const Question& ask) noexcept {
  return ask.command.state_seq > ask.memory.state_seq;
}

bool answers_recent_state(const Question& ask) noexcept {
  const std::int64_t seq = ask.command.state_seq;  // not negative: newer than -1 at least
  return seq <= ask.situation.state_seq && ask.situation.state_seq - seq <= kOldestAnswer;
}

bool all_finite(const Question& ask) noexcept {
  return every_joint(ask, [&](int i) {
    return std::isfinite(ask.command.tau[i]) && std::isfinite(ask.command.tau_preload[i]) &&
           std::isfinite(ask.command.tau_gravity[i]);
  });
}

bool request_known(const Question& ask) noexcept {
  return ask.command.request >= joint_torque_t::REQUEST_KEEP &&
         ask.command.request <= joint_torque_t::REQUEST_ACKNOWLEDGE;
}

bool request_possible(const Question& ask) noexcept {
  return ask.situation.powered || ask.command.request != joint_torque_t::REQUEST_HOLD;
}

/// Each of two motors makes half of tau_preload and, with one sign or the other, half of tau.
bool preload_within_limits(const Question& ask, int i) noexcept {
  const double preload = ask.command.tau_preload[i];
  const double limit = ask.limits.preload_Nm[i];
  return limit > 0.0 ? std::abs(ask.command.tau[i]) + std::abs(preload) <= limit : preload == 0.0;
}

bool torque_within_limits(const Question& ask) noexcept {
  return every_joint(ask, [&](int i) {
    const double limit = ask.limits.torque_Nm[i];
    return std::abs(ask.command.tau[i]) <= limit && std::abs(ask.command.tau_gravity[i]) <= limit &&
           preload_within_limits(ask, i);
  });
}

bool torque_step_within_limits(const Question& ask) noexcept {
  return !ask.situation.followed || every_joint(ask, [&](int i) {
    const double step = ask.command.tau[i] - ask.situation.torque_present[i];
    const double preload_step = ask.command.tau_preload[i] - ask.situation.preload_present[i];
    return std::abs(step) <= ask.limits.torque_step_Nm[i] &&
           std::abs(preload_step) <= ask.limits.preload_step_Nm[i];
  });
}

bool power_within_limit(const Question& ask) noexcept {
  double power_W = 0.0;
  for (int i = 0; i < ask.limits.n; ++i) power_W += ask.command.tau[i] * ask.situation.velocity[i];
  return !ask.situation.followed || power_W <= ask.limits.power_W;
}

struct Check {
  int verdict;
  bool (*passes)(const Question&) noexcept;
};

// The order is the documented one: who speaks, about what, then what is said.
constexpr Check kChecks[] = {
    {driver_status_t::VERDICT_SIZE, size_fits},
    {driver_status_t::VERDICT_SESSION, session_is_ours},
    {driver_status_t::VERDICT_CONTROLLER, controller_may},
    {driver_status_t::VERDICT_REPLAYED, answers_newer_state},
    {driver_status_t::VERDICT_STALE, answers_recent_state},
    {driver_status_t::VERDICT_NOT_FINITE, all_finite},
    {driver_status_t::VERDICT_REQUEST, request_known},
    {driver_status_t::VERDICT_NOT_ON, request_possible},
    {driver_status_t::VERDICT_TORQUE, torque_within_limits},
    {driver_status_t::VERDICT_RATE, torque_step_within_limits},
    {driver_status_t::VERDICT_POWER, power_within_limit},
};

}  // namespace

int check_command(const GateLimits& limits, const GateMemory& memory,
                  const GateSituation& situation, const joint_torque_t& command) noexcept {
  const Question ask{limits, memory, situation, command};
  for (const Check& check : kChecks) {
    if (!check.passes(ask)) return check.verdict;
  }
  return driver_status_t::VERDICT_ACCEPTED;
}

void TorqueGate::next_cycle() noexcept {
  ++cycle_;
  if (++memory_.silent_cycles >= limits_.lease_cycles) memory_.controller = 0;
}

int TorqueGate::judge(const joint_torque_t& command, const GateSituation& situation) noexcept {
  const int verdict = check_command(limits_, memory_, situation, command);
  too_often_ = false;
  if (verdict == driver_status_t::VERDICT_ACCEPTED) {
    memory_ = {command.controller, 0, command.state_seq};
    return verdict;
  }
  const bool from_holder = memory_.controller != 0 && command.session == limits_.session &&
                           command.controller == memory_.controller;
  if (from_holder && verdict != driver_status_t::VERDICT_REPLAYED) {
    too_often_ = refusals_.add(cycle_, limits_.refusal_cycles);
  }
  return verdict;
}

}  // namespace limber
