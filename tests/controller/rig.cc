#include "tests/controller/rig.h"

#include <algorithm>

#include "controller/modes/state_judge.h"
#include "robots/loader/default_gains.h"

namespace limber::testing {
namespace {

ArmControllerOptions options_for(const std::string& law, int bridged_cycles) {
  ArmControllerOptions options;
  options.controller = 3;
  options.law = law;
  options.bridged_cycles = bridged_cycles;
  options.measure_time = false;
  options.simulated = true;
  options.allow_unstable = true;  // what a test asks for acts
  return options;
}

}  // namespace

Rig::Rig(const LoadedRobot& given, const std::string& law, int bridged_cycles)
    : robot(given), controller(robot, options_for(law, bridged_cycles)), plant(robot) {
  const int n = robot.robot.size();
  viscous = VectorJ::Zero(n);
  plant.q.setConstant(0.4);
  state.seq = -1;
  state.session = 11;
  state.period_ns = 1'000'000;
  state.num_joints = static_cast<std::int8_t>(n);
  state.drive_state = joint_state_t::DRIVE_OFF;
  state.fault_joint = -1;
  const controller::JointFlags flags = controller::equipment_of(robot.robot);
  for (int i = 0; i < n; ++i) {
    state.joint_flags[i] = joint_state_t::JOINT_FRESH | flags[static_cast<std::size_t>(i)];
  }
  if (std::any_of(robot.robot.joints.begin(), robot.robot.joints.end(),
                  [](const JointConfig& joint) { return !joint.rigid(); })) {
    elastic.emplace(robot);
    elastic->rest_at(plant.q);
  }
}

const joint_command_t& Rig::step() {
  ++state.seq;
  state.time_ns = state.seq * state.period_ns;
  const int n = state.num_joints;
  const bool on = state.drive_state == joint_state_t::DRIVE_ON;
  const VectorJ sent =
      on ? VectorJ(Eigen::Map<const Eigen::VectorXd>(answer.tau, n)) : VectorJ::Zero(n);
  read_sensors(sent);
  if (on) {
    move(sent);
  } else {
    plant.v.setZero();
  }
  const joint_command_t before = answer;
  answer = controller.step(state);
  for (int i = 0; i < n; ++i) jump_ = std::max(jump_, std::abs(answer.tau[i] - before.tau[i]));
  limits_ |= controller.status().limits;
  follow_request();
  return answer;
}

void Rig::read_sensors(const VectorJ& sent) {
  for (int i = 0; i < state.num_joints; ++i) {
    const bool spring = elastic && !robot.robot.joints[static_cast<std::size_t>(i)].rigid();
    state.theta[i] = spring ? elastic->theta[i] : plant.q[i];
    state.theta_dot[i] = spring ? elastic->theta_dot[i] : plant.v[i];
    const bool link = !spring || (state.joint_flags[i] & joint_state_t::JOINT_LINK_ENCODER) != 0;
    state.q[i] = link ? plant.q[i] : state.theta[i];
    state.v[i] = link ? plant.v[i] : state.theta_dot[i];
    state.tau_applied[i] = state.tau[i] = sent[i];
    if (!spring) continue;
    if ((state.joint_flags[i] & joint_state_t::JOINT_TORQUE_SENSOR) != 0) {
      state.tau[i] = elastic->joint_torque(i);
    }
    state.preload[i] = static_cast<float>(elastic->c[i]);
    state.preload_dot[i] = static_cast<float>(elastic->c_dot[i]);
    state.tau_preload_applied[i] = static_cast<float>(answer.tau_preload[i]);
  }
}

void Rig::move(const VectorJ& sent) {
  if (!elastic) {
    plant.advance(1e-3, [&](const VectorJ&, const VectorJ& v) {
      return VectorJ(sent - viscous.cwiseProduct(v));
    });
    return;
  }
  elastic->F_ext = plant.F_ext;
  elastic->advance(1e-3, sent, Eigen::Map<const Eigen::VectorXd>(answer.tau_preload, sent.size()));
  plant.q = elastic->q;
  plant.v = elastic->v;
}

void Rig::follow_request() {
  switch (answer.request) {
    case joint_command_t::REQUEST_ON:
    case joint_command_t::REQUEST_ACKNOWLEDGE:
      state.drive_state = joint_state_t::DRIVE_ON;
      break;
    case joint_command_t::REQUEST_OFF:
      state.drive_state = joint_state_t::DRIVE_OFF;
      break;
    case joint_command_t::REQUEST_HOLD:
      state.drive_state = joint_state_t::DRIVE_HOLD;
      break;
    default:
      break;
  }
}

void Rig::run(double seconds) {
  for (int i = 0; i < static_cast<int>(seconds * 1e3 + 0.5); ++i) step();
}

void Rig::to_hold() {
  run(0.12);
  request(mode_request_t::REQUEST_HOLD);
  run(1.5);
}

void Rig::to_active() {
  to_hold();
  request(mode_request_t::REQUEST_ACTIVE);
  run(0.7);
  clear_jumps();
}

const char* Rig::request(std::int8_t request, std::int64_t client) {
  mode_request_t message{};
  message.client = client;
  message.request = request;
  return controller.on_mode(message);
}

compliance_gains_t Rig::gains() const {
  compliance_gains_t message = default_gains(robot.robot);
  message.client = kClient;
  return message;
}

compliance_goal_t Rig::goal() const {
  compliance_goal_t message{};
  message.client = kClient;
  message.num_joints = state.num_joints;
  message.kind = compliance_goal_t::GOAL_OFFSET;
  message.quat_BD[0] = 1.0;
  return message;
}

VectorJ Rig::tau() const { return Eigen::Map<const Eigen::VectorXd>(answer.tau, state.num_joints); }

void Rig::clear_jumps() {
  jump_ = 0.0;
  limits_ = 0;
}

}  // namespace limber::testing
