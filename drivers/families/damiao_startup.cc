// Start-up of Damiao drives:
//
//   PMAX, VMAX, TMAX equal robot.yaml -> CTRL_MODE := MIT, read back
//     -> TIMEOUT := watchdog_s, read back -> OT_Value is above limit_temperature_degC
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "drivers/families/damiao_family.h"
#include "drivers/protocols/mit.h"

namespace limber {
namespace {

constexpr std::uint32_t kModeMit = 1;
constexpr double kTolerance = 1e-4;  // float32 against what people write: 12.566 for 4 pi

std::uint32_t as_float(double value) noexcept { return mit::float_bits(static_cast<float>(value)); }

bool is_float(mit::Register reg) noexcept {
  return reg == mit::Register::kOverTemperature || reg == mit::Register::kPositionRange ||
         reg == mit::Register::kVelocityRange || reg == mit::Register::kTorqueRange;
}

double value_of(mit::Register reg, std::uint32_t raw) noexcept {
  return is_float(reg) ? static_cast<double>(mit::bits_float(raw)) : static_cast<double>(raw);
}

class DamiaoStartup final : public StartupDialogue {
 public:
  DamiaoStartup(const JointConfig& joint, bool fd);

  CanFrame presence_request() const noexcept override;
  bool is_presence(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.reply_id);
  }
  /// As delivered, a drive answers with identifier 0.
  bool has_wrong_reply_id(const CanFrame& frame) const noexcept override;
  const char* reply_id_setting() const noexcept override { return "Damiao: MST_ID, register 7"; }

  /// The last one is left out if there is no limit.
  int steps() const noexcept override;
  StartupStep step(int index) const noexcept override;
  CanFrame request(int index) const noexcept override;
  bool can_be_polled(int index) const noexcept override {
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

  std::uint16_t id() const noexcept { return static_cast<std::uint16_t>(drive_.command_id); }

  DriveConfig drive_;
  bool fd_;
  std::array<Step, kSteps> steps_;
};

DamiaoStartup::DamiaoStartup(const JointConfig& joint, bool fd) : drive_(joint.drive), fd_(fd) {
  using mit::Register;
  const CommandRange& range = drive_.range;
  const auto timeout =
      static_cast<std::uint32_t>(std::lround(drive_.watchdog_s / mit::kTimeoutCount_s));
  steps_ = {{
      {Kind::kCompareRange, Register::kPositionRange, as_float(range.position_rad)},
      {Kind::kCompareRange, Register::kVelocityRange, as_float(range.velocity_rad_per_s)},
      {Kind::kCompareRange, Register::kTorqueRange, as_float(range.torque_Nm)},
      {Kind::kWrite, Register::kControlMode, kModeMit},
      {Kind::kReadBack, Register::kControlMode, kModeMit},
      {Kind::kWrite, Register::kTimeout, timeout},
      {Kind::kReadBack, Register::kTimeout, timeout},
      {Kind::kCompareAbove, Register::kOverTemperature, as_float(drive_.limit_temperature_degC)},
  }};
}

CanFrame DamiaoStartup::presence_request() const noexcept {
  return mit::encode_register_read(id(), mit::Register::kControlMode, fd_);
}

bool DamiaoStartup::has_wrong_reply_id(const CanFrame& frame) const noexcept {
  std::uint32_t mode = 0;
  return !has_id(frame, drive_.reply_id) && !frame.extended && frame.id != mit::kRegisterId &&
         mit::decode_register(frame, id(), mit::kReadRegister, mit::Register::kControlMode, &mode);
}

int DamiaoStartup::steps() const noexcept {
  return std::isfinite(drive_.limit_temperature_degC) ? kSteps : kSteps - 1;
}

StartupStep DamiaoStartup::step(int index) const noexcept {
  const Step& step = steps_[static_cast<std::size_t>(index)];
  return {static_cast<std::uint32_t>(step.reg), value_of(step.reg, step.raw)};
}

CanFrame DamiaoStartup::request(int index) const noexcept {
  const Step& step = steps_[static_cast<std::size_t>(index)];
  return step.kind == Kind::kWrite ? mit::encode_register_write(id(), step.reg, step.raw, fd_)
                                   : mit::encode_register_read(id(), step.reg, fd_);
}

Answer DamiaoStartup::check_answer(int index, const CanFrame& frame, double* found) noexcept {
  const Step& step = steps_[static_cast<std::size_t>(index)];
  std::uint32_t raw = 0;
  const std::uint8_t operation =
      step.kind == Kind::kWrite ? mit::kWriteRegister : mit::kReadRegister;
  if (!mit::decode_register(frame, id(), operation, step.reg, &raw)) return Answer::kNone;
  *found = value_of(step.reg, raw);
  const double expected = value_of(step.reg, step.raw);
  bool right = raw == step.raw;
  if (step.kind == Kind::kCompareRange)
    right = std::abs(*found - expected) <= kTolerance * expected;
  if (step.kind == Kind::kCompareAbove) right = *found > expected;
  return right ? Answer::kRight : Answer::kWrong;
}

std::string DamiaoStartup::describe(const StartupFailure& failure) const {
  const bool heat = failure.reg == static_cast<std::uint32_t>(mit::Register::kOverTemperature);
  if (!heat || failure.answer != Answer::kWrong) return StartupDialogue::describe(failure);
  return fmt::format(
      "register 2 (over-temperature) is {:g}, expected more than {:g}: the drive "
      "would let go before limit_temperature_degC stops the arm",
      failure.found, failure.expected);
}

}  // namespace

std::unique_ptr<StartupDialogue> damiao_startup(const JointConfig& joint, bool fd) {
  return std::make_unique<DamiaoStartup>(joint, fd);
}

}  // namespace limber
