// An emulated RobStride drive: what a real one does with each frame of the private protocol, and
// when it lets go by itself. Written from the manuals, not from limber's family.
//
// Every frame for the node is answered: pings with its unique number, reads with the value or a
// refusal, the others with the state before the frame takes effect.
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/robstride.h"
#include "robots/loader/robot.h"
#include "sim/nodes/motor_node.h"

namespace limber::sim {

/// Stopped (phases open), or running the five numbers of the last command; of the other run modes
/// none moves the joint here. As in the real drive
///   - the time-out is off when it is delivered, and lets go without a fault when it expires;
///   - the run mode changes only while stopped, and a write is answered the same if it does not;
///   - a read of what the firmware does not have is answered with 0 and a flag;
///   - a fault comes in a frame of its own besides the bits of each state;
///   - states come without a request while that is switched on (type 24).
/// After construction every member is allowed in the cycle.
class RobstrideNode final : public MotorNode {
 public:
  explicit RobstrideNode(const JointConfig& joint);

  bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
               CanFrame* reply) noexcept override;
  bool next_frame(CanFrame* frame) noexcept override;
  void update(const JointReading& joint, std::int64_t now_ns) noexcept override;
  DriveLaw law() const noexcept override;
  bool enabled() const noexcept override { return mode_ == robstride::Mode::kRun; }

 private:
  /// DRIVE_ERROR is an over-current.
  void on_fault(int fault, const JointReading& joint) noexcept override;
  double position(const JointReading& joint) const noexcept;
  robstride::State state(const JointReading& joint) const noexcept;
  void act(const robstride::Id& id, const CanFrame& frame, const JointReading& joint) noexcept;
  void write(const robstride::ParameterRequest& request) noexcept;
  CanFrame read(std::uint16_t index, std::uint8_t host, const JointReading& joint) const noexcept;
  void stop(bool shorted) noexcept;

  DriveConfig drive_;
  std::uint8_t number_;
  std::uint8_t host_ = robstride::kHost;  ///< who spoke last
  robstride::Mode mode_ = robstride::Mode::kReset;
  std::uint8_t faults_ = 0;
  bool shorted_ = false;
  robstride::Command command_;
  double zero_ = 0.0;  ///< added to the drive's angle
  double frozen_position_ = 0.0;
  std::uint8_t run_mode_ = 0;
  std::uint32_t timeout_counts_ = 0;
  std::uint16_t report_period_ = 1;
  bool reports_ = false;
  bool fault_to_tell_ = false;
  std::int64_t last_frame_ns_ = 0;
  std::int64_t last_report_ns_ = 0;
  JointReading seen_;  ///< by the last update
};

}  // namespace limber::sim
