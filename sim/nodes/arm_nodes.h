// Everything of the arm that is on a bus: its drives, its tip sensor, its emergency stop.
#pragma once

#include <optional>
#include <vector>

#include "sim/nodes/emergency_stop_node.h"
#include "sim/nodes/hand_node.h"
#include "sim/nodes/motor_nodes.h"
#include "sim/nodes/tip_sensor.h"
#include "sim/plant/simulated_arm.h"
#include "sim/world/world_event.h"

namespace limber::sim {

/// After construction every member but steps_per_period() is allowed in the cycle.
class ArmNodes {
 public:
  /// `robot` is how the drives are configured, `plant` the arm with its sensors. Throws
  /// ConfigError.
  ArmNodes(const Robot& robot, const Robot& plant, const SimulatedArm& arm);

  /// See MotorNodes. Throws ConfigError. Set-up only.
  std::int64_t steps_per_period(double rate_hz, double step_s) const {
    return motors_.steps_per_period(rate_hz, step_s, hand_ ? hand_->drive().loop_rate_hz() : 0.0);
  }

  /// Senders beside the driver: the motors, the tip sensor, the emergency stop, the hand.
  int size() const noexcept { return motors_.size() + (hand_ ? 3 : 2); }
  /// Hands a frame from a bus to its nodes and sends their answers there.
  void receive(int bus, const CanFrame& frame, std::int64_t now_ns, BusSide* out) noexcept;
  void send_pending_of(int bus, std::int64_t now_ns, BusSide* out) noexcept {
    motors_.send_pending_of(bus, now_ns, out);
    if (hand_) hand_->send_pending_of(bus, now_ns, out);
  }
  /// After an integration step of h seconds: sensors, loops, watchdogs, unsolicited frames.
  void update(const SimulatedArm& arm, double h, std::int64_t now_ns,
              std::vector<BusSide>* buses) noexcept;
  void update_tip_sensor(const SimulatedArm& arm, double h, std::int64_t now_ns) noexcept;

  /// Hands the torque laws at work to the motors.
  void command(SimulatedArm* arm) const noexcept {
    motors_.command(&arm->forces());
    if (hand_) arm->hand_law = hand_->drive().law();
  }
  bool all_enabled() const noexcept {
    return motors_.all_enabled() && (!hand_ || hand_->drive().enabled());
  }
  /// Joints that can have faults: the arm's, then the hand.
  int joints() const noexcept { return joints_ + (hand_ ? 1 : 0); }
  bool has_tip_sensor() const noexcept { return tip_sensor_.has_value(); }
  bool has_emergency_stop() const noexcept { return emergency_stop_.has_value(); }

  /// The tip sensor's mechanics carry the payload, too.
  void set_payload(const SimulatedArm& arm, double mass, const Eigen::Vector3d& p_TL) noexcept;
  void inject(const NodeFault& fault, std::int64_t now_ns) noexcept;
  void clear_faults() noexcept;
  /// See MotorNodes.
  void tell(int joint, const CanFrame& frame, std::int64_t now_ns) noexcept {
    motors_.tell(joint, frame, now_ns);
    if (hand_ && joint == joints_) hand_->tell(frame, now_ns);
  }

 private:
  int joints_;
  MotorNodes motors_;
  std::optional<HandNode> hand_;
  std::optional<TipSensor> tip_sensor_;
  std::optional<EmergencyStopNode> emergency_stop_;
};

}  // namespace limber::sim
