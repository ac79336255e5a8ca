// moteus drives: registers over CAN-FD, everything in each cycle's frame.
//
// Start-up: register map version compared -> home state compared -> telemetry stopped
//            -> settings read over the diagnostic channel and compared: kp, kd, ki, position range
// The watchdog needs no step: every command carries it.
#pragma once

#include <array>
#include <cmath>
#include <string_view>

#include "drivers/families/drive_family.h"
#include "drivers/protocols/moteus.h"

namespace limber {

class MoteusFamily final : public DriveFamily {
 public:
  explicit MoteusFamily(const JointConfig& joint);

  /// Position mode with scaled gains; without stiffness the position goes as NaN, and torque alone
  /// with both scales zero. The scales are independent of each other: the manual's limit of the one
  /// by the other is not in the firmware.
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
  bool is_foreign_command(const CanFrame& frame) const noexcept override;
  std::vector<CanFilter> receive_filters() const override;
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override;

  /// Text is answered from the drive's main loop, not at once.
  int patience_cycles() const noexcept override { return 5; }
  /// The last question is left out if there is no limit_temperature_degC.
  int startup_steps() const noexcept override {
    return std::isfinite(drive_.limit_temperature_degC) ? kSteps : kSteps - 2;
  }
  StartupStep startup_step(int index) const noexcept override;
  CanFrame startup_request(int index) const noexcept override;
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override;
  std::string describe(const StartupFailure& failure) const override;

 private:
  /// A line for the diagnostic channel, and what is wanted of the answer.
  struct Question {
    std::string_view line;
    bool (*right)(double found, double expected);  ///< none: any answer
    double expected;
  };
  static constexpr int kRegisters = 2;
  static constexpr int kQuestions = 7;
  static constexpr int kSteps = kRegisters + 2 * kQuestions;  // a line takes two: sent, answered

  static int question_of(int index) noexcept { return (index - kRegisters) / 2; }
  Answer check_register(int index, const CanFrame& frame, double* found) const noexcept;
  Answer check_line(const Question& question, std::string_view text, double* found) noexcept;

  DriveConfig drive_;
  double torque_limit_;  ///< N m
  std::array<Question, kQuestions> questions_;
  bool speaks_ = true;  ///< has a diagnostic channel
  std::array<char, 32> line_{};
  std::size_t line_size_ = 0;
};

}  // namespace limber
