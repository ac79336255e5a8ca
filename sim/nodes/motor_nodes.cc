#include "sim/nodes/motor_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/config_error.h"
#include "robots/loader/second_motor.h"

namespace limber::sim {
namespace {

/// The second drive of an antagonistic joint: a motor and nothing else.
JointConfig antagonist_of(const JointConfig& joint) {
  JointConfig out = second_motor(joint);
  out.has_antagonist = false;
  return out;
}

bool whole(double ratio) { return ratio > 0.5 && std::abs(ratio - std::round(ratio)) < 1e-6; }

}  // namespace

JointConfig as_mounted(const JointConfig& believed, const JointConfig& real) {
  JointConfig out = believed;
  out.drive.command_id = real.drive.command_id;
  out.drive.reply_id = real.drive.reply_id;
  out.drive.sign = real.drive.sign;
  out.drive.offset_rad = real.drive.offset_rad;
  out.antagonist.sign = real.antagonist.sign;
  out.antagonist.offset_rad = real.antagonist.offset_rad;
  return out;
}

MotorNodes::MotorNodes(const Robot& robot, const Robot& plant, const ForceModel& forces,
                       const ArmState& x) {
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& real = plant.joints[i];
    const JointConfig joint = as_mounted(robot.joints[i], real);
    add(joint, i, robot);
    if (joint.has_antagonist) add(antagonist_of(joint), i, robot);
    const auto seed = static_cast<unsigned>(i);
    for (int k = 0; k < real.motors(); ++k)
      motor_encoders_.emplace_back(real.motor_encoder,
                                   static_cast<unsigned>(kMaxMotors + motor_encoders_.size()));
    link_encoders_.emplace_back(real.link_encoder.errors, seed);
    torque_sensors_.emplace_back(real.torque_sensor, seed);
  }
  for (int k = 0; k < size(); ++k) read(k, forces, x);
}

void MotorNodes::add(const JointConfig& joint, int index, const Robot& robot) {
  const int bus = joint.drive.bus;
  nodes_.push_back(
      {make_motor_node(joint, robot.buses[bus].fd), bus, index, joint.torque_sensor.present, {}});
}

std::int64_t MotorNodes::steps_per_period(double rate_hz, double step_s, double loop_hz) const {
  constexpr std::int64_t kMostTimes = 1000;
  // The tolerance keeps 0.001 / 0.00025 from becoming 5 steps by rounding.
  const std::int64_t fewest =
      std::max(1LL, std::llround(std::ceil(1.0 / (rate_hz * step_s) - 1e-6)));
  for (std::int64_t steps = fewest; steps <= kMostTimes * fewest; ++steps) {
    const double per_second = rate_hz * static_cast<double>(steps);
    const auto fits = [per_second](double of_hz) {
      return of_hz == 0.0 || whole(per_second / of_hz);
    };
    if (fits(loop_hz) && std::ranges::all_of(nodes_, fits, [](const Node& node) {
          return node.motor->loop_rate_hz();
        }))
      return steps;
  }
  throw ConfigError(fmt::format(
      "no whole number of integration steps makes both a control period at {} Hz and a period of "
      "the drives' torque loops; rates with a small common multiple are needed",
      rate_hz));
}

void MotorNodes::read(int motor, const ForceModel& forces, const ArmState& x) noexcept {
  const MotorPoint at = forces.point(x, motor);
  const Motor& stage = forces.motor(motor);
  Node& node = nodes_[motor];
  JointReading& out = node.reading;
  const AngleReading motor_side = motor_encoders_[motor].reading({at.theta, at.theta_dot});
  const AngleReading link_side = link_encoders_[node.joint].reading({at.q, at.v});
  out.theta = motor_side.angle;
  out.theta_dot = motor_side.rate;
  out.q = link_side.angle;
  out.v = link_side.rate;
  out.motor_torque = stage.estimated_torque(at);
  if (node.senses_torque) out.joint_torque = torque_sensors_[node.joint].reading();
  out.current_A = stage.current_A(at);
  out.winding_degC = stage.winding_degC();
}

void MotorNodes::receive(int bus, const CanFrame& frame, std::int64_t now_ns,
                         BusSide* out) noexcept {
  CanFrame reply;
  for (int k = 0; k < static_cast<int>(nodes_.size()); ++k) {
    if (nodes_[k].bus != bus) continue;
    if (nodes_[k].motor->receive(frame, nodes_[k].reading, now_ns, &reply)) {
      out->send(k, reply, now_ns);
    }
    send_pending(k, now_ns, out);
  }
}

void MotorNodes::send_pending_of(int bus, std::int64_t now_ns, BusSide* out) noexcept {
  for (int k = 0; k < size(); ++k) {
    if (nodes_[k].bus == bus) send_pending(k, now_ns, out);
  }
}

void MotorNodes::send_pending(int motor, std::int64_t now_ns, BusSide* out) noexcept {
  CanFrame frame;
  while (nodes_[motor].motor->next_frame(&frame)) out->send(motor, frame, now_ns);
}

void MotorNodes::update(const ForceModel& forces, const ArmState& x, double h, std::int64_t now_ns,
                        std::vector<BusSide>* buses) noexcept {
  for (int i = 0; i < static_cast<int>(torque_sensors_.size()); ++i) {
    torque_sensors_[i].update(forces.spring_torque(x, i), h);
    link_encoders_[i].update({x.q[i], x.v[i]}, h);
  }
  for (int k = 0; k < static_cast<int>(nodes_.size()); ++k) {
    motor_encoders_[k].update({x.theta[k], x.theta_dot[k]}, h);
    read(k, forces, x);
    nodes_[k].motor->update(nodes_[k].reading, now_ns);
    send_pending(k, now_ns, &(*buses)[nodes_[k].bus]);
  }
}

void MotorNodes::command(ForceModel* forces) const noexcept {
  for (std::size_t k = 0; k < nodes_.size(); ++k) forces->drives[k] = nodes_[k].motor->law();
}

bool MotorNodes::all_enabled() const noexcept {
  return std::all_of(nodes_.begin(), nodes_.end(),
                     [](const Node& node) { return node.motor->enabled(); });
}

void MotorNodes::inject(int joint, int fault, std::int64_t until_ns) noexcept {
  for (int k = 0; k < static_cast<int>(nodes_.size()); ++k) {
    if (nodes_[k].joint != joint) continue;
    nodes_[k].motor->inject(fault, nodes_[k].reading, until_ns);
  }
}

void MotorNodes::tell(int joint, const CanFrame& frame, std::int64_t now_ns) noexcept {
  CanFrame unheard;
  for (Node& node : nodes_) {
    if (node.joint == joint) node.motor->receive(frame, node.reading, now_ns, &unheard);
  }
}

void MotorNodes::clear_faults() noexcept {
  for (const Node& node : nodes_) node.motor->clear_faults();
}

}  // namespace limber::sim
