// What the gate should say, from the table in docs/safety.md.
#pragma once

#include <cmath>
#include <limber/driver_status_t.hpp>
#include <limber/joint_command_t.hpp>
#include <optional>
#include <vector>

#include "drivers/gate/torque_gate.h"
#include "tests/fuzz/support/fuzz_input.h"

namespace limber::fuzz {

class GateOracle {
 public:
  explicit GateOracle(const GateLimits& limits) : limits_(limits) {}

  void next_cycle() {
    if (accepted_) ++cycles_since_;
  }
  /// The lease lasts from an accepted command to lease_cycles cycles after it.
  bool leased() const { return accepted_ && cycles_since_ < limits_.lease_cycles; }

  int judge(const joint_command_t& command, const GateSituation& now) {
    const int verdict = verdict_of(command, now);
    if (verdict == driver_status_t::VERDICT_ACCEPTED) {
      accepted_ = command;
      cycles_since_ = 0;
    }
    return verdict;
  }

 private:
  using Verdict = driver_status_t;

  int verdict_of(const joint_command_t& c, const GateSituation& now) const {
    if (c.num_joints != limits_.n) return Verdict::VERDICT_SIZE;
    if (c.session != limits_.session) return Verdict::VERDICT_SESSION;
    if (c.controller == 0) return Verdict::VERDICT_CONTROLLER;
    if (leased() && c.controller != accepted_->controller) return Verdict::VERDICT_CONTROLLER;
    const std::int64_t last = accepted_ ? accepted_->state_seq : -1;
    if (c.state_seq <= last) return Verdict::VERDICT_REPLAYED;
    if (c.state_seq > now.state_seq || c.state_seq < now.state_seq - 5)
      return Verdict::VERDICT_STALE;
    if (!finite(c)) return Verdict::VERDICT_NOT_FINITE;
    if (c.request < 0 || c.request > 4) return Verdict::VERDICT_REQUEST;
    if (c.request == joint_command_t::REQUEST_HOLD && !now.powered) return Verdict::VERDICT_NOT_ON;
    if (!within_limits(c)) return Verdict::VERDICT_TORQUE;
    if (!now.followed) return Verdict::VERDICT_ACCEPTED;
    if (!within_steps(c, now)) return Verdict::VERDICT_RATE;
    double power_W = 0.0;
    for (int i = 0; i < limits_.n; ++i) power_W += c.tau[i] * now.velocity[i];
    return power_W > limits_.power_W ? Verdict::VERDICT_POWER : Verdict::VERDICT_ACCEPTED;
  }

  bool finite(const joint_command_t& c) const {
    double sum = 0.0;
    for (int i = 0; i < limits_.n; ++i)
      sum += 0.0 * c.tau[i] + 0.0 * c.tau_preload[i] + 0.0 * c.tau_gravity[i];
    return sum == 0.0;  // NaN if one is not finite
  }

  bool within_limits(const joint_command_t& c) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const double most = limits_.torque_Nm[i];
      if (std::fabs(c.tau[i]) > most || std::fabs(c.tau_gravity[i]) > most) return false;
      const double two = limits_.preload_Nm[i];
      if (two == 0.0 && c.tau_preload[i] != 0.0) return false;
      if (two > 0.0 && std::fabs(c.tau[i]) + std::fabs(c.tau_preload[i]) > two) return false;
    }
    return true;
  }

  bool within_steps(const joint_command_t& c, const GateSituation& now) const {
    const double cycles = cycles_since_ < 1 ? 1.0 : static_cast<double>(cycles_since_);
    for (std::size_t i = 0; i < 3; ++i) {
      const double step = limits_.torque_step_Nm[i];
      if (std::fabs(c.tau[i] - now.torque_present[i]) > step) return false;
      if (std::fabs(c.tau_preload[i] - now.preload_present[i]) > limits_.preload_step_Nm[i])
        return false;
      if (leased() && std::fabs(c.tau_gravity[i] - accepted_->tau_gravity[i]) > 3.0 * cycles * step)
        return false;
    }
    return true;
  }

  GateLimits limits_;
  std::optional<joint_command_t> accepted_;
  std::int64_t cycles_since_ = 0;
};

}  // namespace limber::fuzz
