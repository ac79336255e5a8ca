// A controller that has been brought to ACTIVE, as a client does it.
#pragma once

#include "controller/arm_controller.h"
#include "robots/loader/load_robot.h"
#include "tests/fuzz/support/require.h"

namespace limber::fuzz {

constexpr std::int32_t kClient = 7;

/// The arm at rest at home, with the drives off, of a session of its own.
inline joint_state_t state_at_home(const Robot& arm) {
  joint_state_t state{};
  state.session = 9;
  state.period_ns = 1'000'000;
  state.num_joints = static_cast<std::int8_t>(arm.size());
  for (int i = 0; i < arm.size(); ++i) {
    state.q[i] = state.theta[i] = arm.joints[static_cast<std::size_t>(i)].home;
    state.joint_flags[i] = joint_state_t::JOINT_FRESH;
  }
  state.drive_state = joint_state_t::DRIVE_OFF;
  return state;
}

/// The joint is held by its brake until its weight is carried, and the drives do what is requested.
/// step(): a cycle. The last request.
template <typename Step>
mode_request_t activate(ArmController* controller, const Step& step) {
  constexpr int kCycles = 400;
  mode_request_t request{};
  request.client = kClient;
  for (int i = 0; i < kCycles; ++i) {
    step();
    const std::int8_t mode = controller->status().mode;
    if (mode == controller_status_t::MODE_ACTIVE) continue;
    const bool holds = mode == controller_status_t::MODE_HOLD;
    request.request = holds ? mode_request_t::REQUEST_ACTIVE : mode_request_t::REQUEST_HOLD;
    ++request.seq;
    controller->on_mode(request);
  }
  require(controller->status().mode == controller_status_t::MODE_ACTIVE, "a law runs");
  return request;
}

inline std::int8_t drives_after(const joint_command_t& command) {
  const bool on = command.request != joint_command_t::REQUEST_OFF;
  return on ? joint_state_t::DRIVE_ON : joint_state_t::DRIVE_OFF;
}

}  // namespace limber::fuzz
