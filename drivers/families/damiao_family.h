// Damiao drives: MIT frames, registers for the start-up.
//
// Start-up: PMAX, VMAX, TMAX equal robot.yaml -> CTRL_MODE := MIT, read back
//            -> TIMEOUT := watchdog_s, read back -> OT_Value is above limit_temperature_degC
#pragma once

#include <array>

#include "drivers/families/drive_family.h"
#include "drivers/protocols/mit.h"

namespace limber {

class DamiaoFamily final : public DriveFamily {
 public:
  DamiaoFamily(const JointConfig& joint, bool fd);

  /// The rounding error of the torque field is added to the next torque (first-order noise
  /// shaping): the mean over the cycles is exact although a count is up to 14 mN m, and there is no
  /// exact zero. Neither that nor rounding carries a torque over the joint's limit.
  bool command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
               DriveCommand* sent) noexcept override;
  CanFrame disable() noexcept override { return special(mit::Special::kDisable); }
  CanFrame clear_error() noexcept override { return special(mit::Special::kClearError); }
  CanFrame enable(const DriveMemory& /*memory*/) noexcept override {
    return special(mit::Special::kEnable);
  }
  CanFrame state_request() const noexcept override;
  CanFrame presence_request() const noexcept override;

  bool is_mine(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.reply_id);
  }
  /// Frames with its identifier, and register writes to it.
  bool is_foreign_command(const CanFrame& frame) const noexcept override;
  std::vector<CanFilter> receive_filters() const override;
  /// A register's answer looks like a state: only who asked tells them apart.
  void note_foreign(const CanFrame& frame) noexcept override;
  bool answers_foreign(const CanFrame& frame) noexcept override;
  void begin_cycle() noexcept override;
  /// As delivered, a drive answers with identifier 0 (MST_ID).
  bool is_astray(const CanFrame& frame) const noexcept override;
  /// Half a count is added to the fields, because drives truncate.
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override;

  /// The last one is left out if there is no limit.
  int startup_steps() const noexcept override;
  StartupStep startup_step(int index) const noexcept override;
  CanFrame startup_request(int index) const noexcept override;
  bool may_be_read_again(int index) const noexcept override {
    const Kind kind = steps_[static_cast<std::size_t>(index)].kind;
    return kind == Kind::kCompareRange || kind == Kind::kReadBack;
  }
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override;
  std::string describe(const StartupFailure& failure) const override;

 private:
  enum class Kind : std::uint8_t { kCompareRange, kWrite, kReadBack, kCompareAbove };
  struct Step {
    Kind kind;
    mit::Register reg;
    std::uint32_t raw;  ///< expected or written
  };
  static constexpr int kSteps = 8;
  /// A register that somebody else reads or writes.
  struct ForeignRequest {
    std::uint8_t operation = 0;
    std::uint8_t reg = 0;
    int cycles_left = 0;  ///< in which the answer may come
  };

  CanFrame special(mit::Special special) noexcept;
  std::uint16_t id() const noexcept { return static_cast<std::uint16_t>(drive_.command_id); }

  DriveConfig drive_;
  bool fd_;
  double most_torque_;  ///< N m: the limit less what rounding may add
  double carry_ = 0.0;  ///< rounding error not sent yet, N m
  std::array<Step, kSteps> steps_;
  std::array<ForeignRequest, 8> foreign_;  ///< a ring: more at a time nobody asks
  std::size_t next_foreign_ = 0;
};

}  // namespace limber
