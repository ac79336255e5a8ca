// The drives of the arm: a node a motor, what its sensors see, and its bus.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "robots/loader/robot.h"
#include "sim/joints/encoder.h"
#include "sim/joints/torque_sensor.h"
#include "sim/nodes/motor_node.h"
#include "sim/plant/force_model.h"
#include "sim/wire/bus_side.h"

namespace limber::sim {

/// What drives know is from robot.yaml; how they are mounted and wired is the arm's. Set-up only.
JointConfig as_mounted(const JointConfig& believed, const JointConfig& real);

/// After construction every member but steps_per_period() is allowed in the cycle.
class MotorNodes {
 public:
  /// `robot` is how the drives are configured, `plant` the arm with its sensors, which is at x;
  /// the force model gives the motor torques there.
  MotorNodes(const Robot& robot, const Robot& plant, const ForceModel& forces, const ArmState& x);

  /// The fewest integration steps no longer than step_s of which a whole number makes a control
  /// period, and another the period of every sampled loop in the drives, and of one more at
  /// `loop_hz` (0: none). Throws ConfigError if there is none within a thousand times as many.
  std::int64_t steps_per_period(double rate_hz, double step_s, double loop_hz = 0.0) const;

  int size() const noexcept { return static_cast<int>(nodes_.size()); }
  /// Hands a frame from a bus to its nodes and sends their answers there.
  void receive(int bus, const CanFrame& frame, std::int64_t now_ns, BusSide* out) noexcept;
  /// What the nodes of a bus send unasked, such as a boot-up message.
  void send_pending_of(int bus, std::int64_t now_ns, BusSide* out) noexcept;
  /// After an integration step of h seconds: sensors, loops, watchdogs, then unsolicited
  /// frames.
  void update(const ForceModel& forces, const ArmState& x, double h, std::int64_t now_ns,
              std::vector<BusSide>* buses) noexcept;
  /// Takes over the torque laws at work.
  void command(ForceModel* forces) const noexcept;

  bool all_enabled() const noexcept;
  /// On all motors of a joint.
  void inject(int joint, int fault, std::int64_t until_ns) noexcept;
  void clear_faults() noexcept;
  /// The motors of a joint get a frame past their bus, which does not carry what they answer.
  void tell(int joint, const CanFrame& frame, std::int64_t now_ns) noexcept;

 private:
  struct Node {
    std::unique_ptr<MotorNode> motor;
    int bus;
    int joint;
    bool senses_torque;
    JointReading reading;  ///< since the last update()
  };
  void add(const JointConfig& joint, int index, const Robot& robot);
  void read(int motor, const ForceModel& forces, const ArmState& x) noexcept;
  void send_pending(int motor, std::int64_t now_ns, BusSide* out) noexcept;

  std::vector<Node> nodes_;                   // in the order of the motors
  std::vector<Encoder> motor_encoders_;       // likewise
  std::vector<Encoder> link_encoders_;        // one a joint
  std::vector<TorqueSensor> torque_sensors_;  // likewise
};

}  // namespace limber::sim
