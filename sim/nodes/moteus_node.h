// An emulated moteus drive: registers over CAN-FD, what a command does, and when the drive stops
// obeying.
//
// A frame is worked through subframe by subframe; it is answered with the state before it takes
// effect, and if an answer was requested there is one, even an empty one. The node speaks the
// drive's own angle (sign and offset of the robot's description, then set-output), in turns.
#pragma once

#include <cstdint>

#include "drivers/protocols/moteus_frame.h"
#include "robots/loader/robot.h"
#include "sim/nodes/moteus_command.h"
#include "sim/nodes/motor_node.h"

namespace limber::sim {

/// Modes: stopped (phases open); 2 to 4 for a millisecond each on the way to position mode;
/// position; fault and time-out, latched until a stop. Other modes are not emulated: asking for one
/// changes nothing. After a time-out the joint is braked with the configured kd and at most
/// DriveConfig::timeout_torque_Nm, or, if the watchdog's reaction is off, not at all.
class MoteusNode final : public MotorNode {
 public:
  explicit MoteusNode(const JointConfig& joint);

  bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
               CanFrame* reply) noexcept override;
  void update(const JointReading& joint, std::int64_t now_ns) noexcept override;
  /// Position mode: kd scale counts up to the kp scale only, and the total is held within the
  /// command's maximum torque and the drive's peak. There is no integrator.
  DriveLaw law() const noexcept override;
  bool enabled() const noexcept override { return mode_ == moteus::Mode::kPosition; }

  moteus::Mode mode() const noexcept { return mode_; }

 private:
  /// DRIVE_ERROR is a fault of the motor driver (33).
  void on_fault(int fault, const JointReading& joint) noexcept override;
  /// The drive's own view of its joint.
  struct Sensed {
    double turns, turns_per_s, torque;
  };
  /// The mode change that a frame requests, made at its end.
  struct Request {
    bool wanted = false;
    moteus::Mode mode = moteus::Mode::kStopped;
  };

  Sensed sense(const JointReading& joint) const noexcept;
  void work(const moteus::Subframe& subframe, const JointReading& joint, Request* request,
            moteus::FrameWriter* answer) noexcept;
  void write(std::uint16_t reg, double value, const JointReading& joint, Request* request,
             moteus::FrameWriter* answer) noexcept;
  void answer_read(const moteus::Subframe& subframe, const JointReading& joint,
                   moteus::FrameWriter* answer) const noexcept;
  bool read(std::uint16_t reg, const JointReading& joint, double* value) const noexcept;
  void change_mode(moteus::Mode wanted, const JointReading& joint) noexcept;
  void leave(moteus::Mode mode, int fault) noexcept;
  double watchdog_s() const noexcept;
  double wanted_turns() const noexcept;

  DriveConfig drive_;
  std::uint8_t id_;
  moteus::Mode mode_ = moteus::Mode::kStopped;
  int fault_ = 0;
  MoteusCommand written_;     ///< as the registers are
  MoteusCommand command_;     ///< at work
  double start_turns_ = 0.0;  ///< wanted angle when the command came
  double zero_turns_ = 0.0;   ///< set-output: added to the drive angle
  std::int64_t command_ns_ = 0;
  std::int64_t enabling_ns_ = 0;
  double frozen_turns_ = 0.0;
};

}  // namespace limber::sim
