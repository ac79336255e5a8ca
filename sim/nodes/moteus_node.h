// An emulated moteus drive: registers over CAN-FD, what a command does, and when the drive stops
// obeying.
//
// A frame is worked through subframe by subframe; it is answered with the state before it takes
// effect, and if an answer was requested there is one, even an empty one. What could not be written
// is told at the answer's end. The node speaks the drive's own angle (sign and offset of the
// robot's description, then set-output), in turns.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "drivers/protocols/moteus_frame.h"
#include "robots/loader/robot.h"
#include "sim/nodes/moteus_command.h"
#include "sim/nodes/moteus_settings.h"
#include "sim/nodes/moteus_telemetry.h"
#include "sim/nodes/moteus_text.h"
#include "sim/nodes/motor_node.h"
#include "sim/nodes/setpoint_profile.h"

namespace limber::sim {

/// Modes: stopped (phases open); 2 to 4 for a millisecond each on the way to position, zero
/// velocity and brake (phases shorted); fault and time-out, latched until a stop. The other modes
/// are not emulated: a request for one is fault 36, motor not configured. After a time-out the
/// joint is braked with the configured kd and at most DriveConfig::timeout_torque_Nm, or, if the
/// watchdog's reaction is off, not at all.
///
/// The diagnostic channel executes `conf`, `tel` and `d` with what is emulated of them.
class MoteusNode final : public MotorNode {
 public:
  explicit MoteusNode(const JointConfig& joint);

  bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
               CanFrame* reply) noexcept override;
  void update(const JointReading& joint, std::int64_t now_ns) noexcept override;
  /// Position mode: the total is held within the command's maximum torque and the drive's peak.
  /// There is no integrator.
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
  /// What a frame requests, done at its end.
  struct Request {
    bool wanted = false;  ///< a mode
    moteus::Mode mode = moteus::Mode::kStopped;
    bool answered = false;
    struct Refused {
      std::uint16_t reg;
      std::uint8_t error;
    };
    std::array<Refused, 32> refused{};
    std::size_t refused_count = 0;

    void refuse(std::uint16_t reg, std::uint8_t error) noexcept {
      if (refused_count < refused.size()) refused[refused_count++] = {reg, error};
    }
  };

  Sensed sense(const JointReading& joint) const noexcept;
  void work(const moteus::Subframe& subframe, const JointReading& joint, Request* request,
            moteus::FrameWriter* answer) noexcept;
  void write(std::uint16_t reg, double value, const JointReading& joint, Request* request) noexcept;
  void answer_read(const moteus::Subframe& subframe, const JointReading& joint,
                   moteus::FrameWriter* answer) const noexcept;
  bool read(std::uint16_t reg, const JointReading& joint, double* value) const noexcept;
  void execute(std::string_view line, const JointReading& joint) noexcept;
  void debug(std::string_view words, const JointReading& joint) noexcept;
  bool debug_command(std::string_view words) noexcept;
  MoteusStats stats(const JointReading& joint) const noexcept;
  void set_output(double turns, const JointReading& joint) noexcept;

  void change_mode(moteus::Mode wanted, const JointReading& joint) noexcept;
  void enter(moteus::Mode mode, const JointReading& joint) noexcept;
  void aim() noexcept;
  void leave(moteus::Mode mode, int fault) noexcept;
  void pass_time(std::int64_t now_ns) noexcept;
  bool is_watched() const noexcept;
  double watchdog_s() const noexcept;
  double kp() const noexcept;
  double kd() const noexcept;
  std::uint8_t id() const noexcept { return static_cast<std::uint8_t>(settings_[Setting::kId]); }

  DriveConfig drive_;
  MoteusSettings settings_;
  MoteusTelemetry telemetry_;
  MoteusText text_;
  moteus::Mode mode_ = moteus::Mode::kStopped;
  moteus::Mode next_mode_ = moteus::Mode::kStopped;  ///< behind modes 2 to 4
  int fault_ = 0;
  MoteusCommand written_;     ///< as the registers are
  MoteusCommand command_;     ///< at work
  SetpointProfile setpoint_;  ///< turns; in position mode
  double zero_turns_ = 0.0;   ///< set-output: added to the drive angle
  std::int64_t command_ns_ = 0;
  std::int64_t enabling_ns_ = 0;
  double frozen_turns_ = 0.0;
};

}  // namespace limber::sim
