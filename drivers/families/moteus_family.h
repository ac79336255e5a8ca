// moteus drives: registers over CAN-FD, everything in each cycle's frame.
//
// Start-up: register map version compared -> home state compared.
// The watchdog needs no step: every command carries it.
#pragma once

#include <array>

#include "drivers/families/drive_family.h"
#include "drivers/protocols/moteus.h"

namespace limber {

class MoteusFamily final : public DriveFamily {
 public:
  explicit MoteusFamily(const JointConfig& joint);

  /// Position mode with scaled gains. Torque alone goes with position NaN and both scales zero.
  /// Drives hold the kd scale at the kp scale or below: where damping asks for more, kp is raised
  /// with it. Commands that only damp carry the angle measured last, so that spring lags the joint
  /// by a cycle and acts like a little more damping.
  bool command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
               DriveCommand* sent) noexcept override;
  CanFrame disable() noexcept override { return moteus::encode_stop(drive_.command_id); }
  CanFrame clear_error() noexcept override { return disable(); }
  /// A command enables the drive, on its way through modes 2 to 4.
  CanFrame enable(const DriveMemory& memory) noexcept override;
  CanFrame state_request() const noexcept override {
    return moteus::encode_state_request(drive_.command_id);
  }
  CanFrame presence_request() const noexcept override { return state_request(); }

  bool is_mine(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.reply_id);
  }
  /// Frames for its number, or for all, whoever they are from.
  bool is_order(const CanFrame& frame) const noexcept override;
  std::vector<CanFilter> heard() const override;
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override;

  int startup_steps() const noexcept override { return kSteps; }
  StartupStep startup_step(int index) const noexcept override;
  CanFrame startup_request(int index) const noexcept override;
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override;

 private:
  static constexpr int kSteps = 2;

  DriveConfig drive_;
  double torque_limit_;  ///< N m
};

}  // namespace limber
