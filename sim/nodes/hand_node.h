// The drive of the hand: its node, what it senses of the fingers, and its bus.
#pragma once

#include <memory>

#include "robots/loader/robot.h"
#include "sim/hand/fingers.h"
#include "sim/joints/encoder.h"
#include "sim/nodes/motor_node.h"
#include "sim/wire/bus_side.h"

namespace limber::sim {

/// After construction every member is allowed in the cycle.
class HandNode {
 public:
  /// `drive` as it is mounted, configured by robot.yaml; the robot has a hand. It counts as sender
  /// `number` on its bus.
  HandNode(const Robot& robot, const JointConfig& drive, int number, const Fingers& fingers);

  void receive(int bus, const CanFrame& frame, std::int64_t now_ns, BusSide* out) noexcept;
  void send_pending_of(int bus, std::int64_t now_ns, BusSide* out) noexcept;
  /// After an integration step of h seconds.
  void update(const Fingers& fingers, double h, std::int64_t now_ns,
              std::vector<BusSide>* buses) noexcept;
  /// See MotorNodes.
  void tell(const CanFrame& frame, std::int64_t now_ns) noexcept;

  MotorNode& drive() noexcept { return *node_; }
  const MotorNode& drive() const noexcept { return *node_; }
  void inject(int fault, std::int64_t until_ns) noexcept {
    node_->inject(fault, reading_, until_ns);
  }

 private:
  void read(const Fingers& fingers) noexcept;

  std::unique_ptr<MotorNode> node_;
  int bus_;
  int number_;
  Encoder encoder_;
  JointReading reading_;
};

}  // namespace limber::sim
