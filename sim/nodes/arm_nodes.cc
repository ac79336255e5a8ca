#include "sim/nodes/arm_nodes.h"

#include <limits>

namespace limber::sim {

ArmNodes::ArmNodes(const Robot& robot, const Robot& plant, const SimulatedArm& arm)
    : joints_(robot.size()), motors_(robot, plant, arm.forces(), arm.state()) {
  if (arm.hand() != nullptr)
    hand_.emplace(robot, as_mounted(robot.hand.value().drive, plant.hand.value().drive),
                  motors_.size() + 2, arm.hand()->fingers());
  if (plant.has_tip_sensor) tip_sensor_.emplace(plant.tip_sensor, arm.body());
  if (plant.emergency_stop) emergency_stop_.emplace(*plant.emergency_stop);
}

void ArmNodes::receive(int bus, const CanFrame& frame, std::int64_t now_ns, BusSide* out) noexcept {
  motors_.receive(bus, frame, now_ns, out);
  if (hand_) hand_->receive(bus, frame, now_ns, out);
  if (!tip_sensor_ || tip_sensor_->bus != bus) return;
  for (const CanFrame& answer : tip_sensor_->node.receive(frame)) {
    out->send(motors_.size(), answer, now_ns);
  }
}

void ArmNodes::update(const SimulatedArm& arm, double h, std::int64_t now_ns,
                      std::vector<BusSide>* buses) noexcept {
  motors_.update(arm.forces(), arm.state(), h, now_ns, buses);
  if (hand_) hand_->update(arm.hand()->fingers(), h, now_ns, buses);
  update_tip_sensor(arm, h, now_ns);
  CanFrame frame;
  if (emergency_stop_ && emergency_stop_->next(now_ns, &frame)) {
    const auto bus = static_cast<std::size_t>(emergency_stop_->bus());
    (*buses)[bus].send(motors_.size() + 1, frame, now_ns);
  }
}

void ArmNodes::update_tip_sensor(const SimulatedArm& arm, double h, std::int64_t now_ns) noexcept {
  if (tip_sensor_) tip_sensor_->update(arm.body(), arm.environment(), h, now_ns);
}

void ArmNodes::set_payload(const SimulatedArm& arm, double mass,
                           const Eigen::Vector3d& p_TL) noexcept {
  if (tip_sensor_) tip_sensor_->load.set_payload(arm.body(), mass, p_TL);
}

void ArmNodes::inject(const NodeFault& fault, std::int64_t now_ns) noexcept {
  constexpr std::int64_t kForEver = std::numeric_limits<std::int64_t>::max();
  const std::int64_t until_ns =
      fault.duration_ns > kForEver - now_ns ? kForEver : now_ns + fault.duration_ns;
  if (fault.joint == scenario_event_t::NODE_TIP_SENSOR) {
    tip_sensor_->node.silence(until_ns);
  } else if (fault.joint == scenario_event_t::NODE_EMERGENCY_STOP) {
    emergency_stop_->inject(fault.fault, until_ns);
  } else if (hand_ && fault.joint == joints_) {
    hand_->inject(fault.fault, until_ns);
  } else {
    motors_.inject(fault.joint, fault.fault, until_ns);
  }
}

void ArmNodes::clear_faults() noexcept {
  motors_.clear_faults();
  if (hand_) hand_->drive().clear_faults();
  if (tip_sensor_) tip_sensor_->node.clear_faults();
  if (emergency_stop_) emergency_stop_->clear_faults();
}

}  // namespace limber::sim
