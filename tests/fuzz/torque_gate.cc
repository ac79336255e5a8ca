// The gate against an oracle that is written from the table in docs/safety.md and shares no code
// with it: every verdict, the lease, what a refusal leaves behind.
#include "drivers/gate/torque_gate.h"

#include "tests/fuzz/support/gate_oracle.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

namespace {

GateLimits limits_of_three() {
  GateLimits limits;
  limits.n = 3;
  limits.session = 77;
  limits.lease_cycles = 20;
  limits.torque_Nm = {10.0, 20.0, 5.0};
  limits.torque_step_Nm = {1.0, 2.0, 0.5};
  limits.preload_Nm = {0.0, 12.0, 0.0};
  limits.preload_step_Nm = {0.0, 4.0, 0.0};
  limits.power_W = 40.0;
  return limits;
}

class Sequence {
 public:
  explicit Sequence(fuzz::FuzzInput input) : input_(input) {}

  void run() {
    while (!input_.empty()) {
      const auto kind = input_.take<std::uint8_t>();
      if (kind % 4 == 0) cycles(kind / 4 % 32);
      if (kind % 4 == 1) arm_changes();
      if (kind % 4 >= 2) command(kind / 4);
    }
  }

 private:
  void cycles(int count) {
    for (int i = 0; i < count; ++i) {
      gate_.next_cycle();
      oracle_.next_cycle();
      ++situation_.state_seq;
    }
    fuzz::require(gate_.leased() == oracle_.leased(), "the lease ends when it should");
  }

  void arm_changes() {
    const auto flags = input_.take<std::uint8_t>();
    situation_.powered = (flags & 1U) != 0;
    situation_.followed = (flags & 2U) != 0;
    for (std::size_t i = 0; i < 3; ++i) situation_.velocity[i] = input_.small();
  }

  void command(unsigned changes) {
    joint_command_t command = good();
    for (unsigned i = 0; i < changes % 4; ++i) spoil(&command);
    const GateMemory before = gate_.memory();
    const int verdict = gate_.judge(command, situation_);
    fuzz::require(verdict == oracle_.judge(command, situation_), "verdict as the table has it");
    if (verdict == driver_status_t::VERDICT_ACCEPTED) return leave(command);
    fuzz::require(same(before, gate_.memory()), "a refused command changes nothing");
  }

  /// What was accepted is what leaves.
  void leave(const joint_command_t& command) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (!situation_.followed) continue;
      situation_.torque_present[i] = command.tau[i];
      situation_.preload_present[i] = command.tau_preload[i];
    }
  }

  joint_command_t good() const {
    joint_command_t command{};
    command.num_joints = 3;
    command.session = limits_.session;
    command.controller = gate_.leased() ? gate_.memory().controller : 5;
    command.state_seq = situation_.state_seq;
    for (std::size_t i = 0; i < 3; ++i) {
      command.tau[i] = situation_.torque_present[i];
      command.tau_preload[i] = situation_.preload_present[i];
      command.tau_gravity[i] = gate_.memory().gravity[i];
    }
    return command;
  }

  void spoil(joint_command_t* command) {
    const auto which = input_.take<std::uint8_t>();
    const std::size_t joint = which / 16 % 3;
    switch (which % 12) {
      case 0:
        command->tau[joint] = input_.take<double>();
        break;
      case 1:
        command->tau_gravity[joint] = input_.take<double>();
        break;
      case 2:
        command->tau_preload[joint] = input_.take<double>();
        break;
      case 3:
      case 4:
        command->tau[joint] += input_.small();
        break;
      case 5:
        command->tau_gravity[joint] += input_.small();
        break;
      case 6:
        command->tau_preload[joint] += input_.small();
        break;
      case 7:
        command->state_seq = input_.take<std::int64_t>();
        break;
      case 8:
        command->state_seq += input_.take<std::int8_t>();
        break;
      case 9:
        command->controller = input_.take<std::int8_t>();
        break;
      case 10:
        command->request = input_.take<std::int8_t>();
        break;
      default:
        command->num_joints = input_.take<std::int16_t>();
        command->session += input_.take<std::int8_t>();
    }
  }

  static bool same(const GateMemory& a, const GateMemory& b) {
    return a.controller == b.controller && a.silent_cycles == b.silent_cycles &&
           a.state_seq == b.state_seq && a.has_gravity == b.has_gravity && a.gravity == b.gravity;
  }

  fuzz::FuzzInput input_;
  const GateLimits limits_ = limits_of_three();
  TorqueGate gate_{limits_};
  fuzz::GateOracle oracle_{limits_};
  GateSituation situation_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Sequence({data, size}).run();
  return 0;
}
