#include "drivers/configure.h"

#include <cmath>

namespace limber {
namespace {

constexpr std::uint8_t kRead = 0x33;
constexpr std::uint8_t kWrite = 0x55;
constexpr std::uint32_t kModeMit = 1;
constexpr double kTolerance = 1e-4;  // float32 against what people write: 12.566 for 4 pi

std::uint32_t as_float(double value) noexcept { return mit::float_bits(static_cast<float>(value)); }

bool is_range(mit::Register reg) noexcept {
  return reg == mit::Register::kPositionRange || reg == mit::Register::kVelocityRange ||
         reg == mit::Register::kTorqueRange;
}

double value_of(mit::Register reg, std::uint32_t raw) noexcept {
  return is_range(reg) ? static_cast<double>(mit::bits_float(raw)) : static_cast<double>(raw);
}

}  // namespace

ConfigureDialogue::ConfigureDialogue(const DriveConfig& drive, bool fd)
    : id_(static_cast<std::uint16_t>(drive.command_id)), fd_(fd) {
  using mit::Register;
  const auto timeout =
      static_cast<std::uint32_t>(std::lround(drive.watchdog_s / mit::kTimeoutCount_s));
  steps_ = {{
      {Kind::kDisable, Register{}, 0},
      {Kind::kCompareRange, Register::kPositionRange, as_float(drive.range.position_rad)},
      {Kind::kCompareRange, Register::kVelocityRange, as_float(drive.range.velocity_rad_per_s)},
      {Kind::kCompareRange, Register::kTorqueRange, as_float(drive.range.torque_Nm)},
      {Kind::kWrite, Register::kControlMode, kModeMit},
      {Kind::kReadBack, Register::kControlMode, kModeMit},
      {Kind::kWrite, Register::kTimeout, timeout},
      {Kind::kReadBack, Register::kTimeout, timeout},
  }};
}

void ConfigureDialogue::start() noexcept {
  step_ = 0;
  attempts_ = 0;
  advanced_ = false;
  failed_ = false;
  failure_ = {};
}

CanFrame ConfigureDialogue::next_frame() const noexcept {
  if (done()) return mit::encode_state_request(id_, fd_);
  const Step& step = steps_[static_cast<std::size_t>(step_)];
  switch (step.kind) {
    case Kind::kDisable:
      return mit::encode_special(mit::Special::kDisable, id_, fd_);
    case Kind::kWrite:
      return mit::encode_register_write(id_, step.reg, step.raw, fd_);
    case Kind::kCompareRange:
    case Kind::kReadBack:
      break;
  }
  return mit::encode_register_read(id_, step.reg, fd_);
}

bool ConfigureDialogue::receive(const CanFrame& frame) noexcept {
  // One answer a cycle: a step that was reached in this cycle has not been asked for yet.
  if (expects_state() || failed_ || advanced_) return false;
  const Step& step = steps_[static_cast<std::size_t>(step_)];
  std::uint32_t raw = 0;
  const std::uint8_t operation = step.kind == Kind::kWrite ? kWrite : kRead;
  if (!mit::decode_register(frame, id_, operation, step.reg, &raw)) return false;
  if (agrees(step, raw)) {
    advance();
  } else {
    fail(true, raw);
  }
  return true;
}

void ConfigureDialogue::receive_state(bool enabled) noexcept {
  if (step_ == 0 && !enabled) advance();
}

void ConfigureDialogue::close_cycle() noexcept {
  if (!advanced_ && !done() && !failed_ && ++attempts_ >= kAttempts) fail(false, 0);
  advanced_ = false;
}

bool ConfigureDialogue::agrees(const Step& step, std::uint32_t raw) const noexcept {
  if (step.kind != Kind::kCompareRange) return raw == step.raw;
  const double expected = value_of(step.reg, step.raw);
  return std::abs(value_of(step.reg, raw) - expected) <= kTolerance * expected;
}

void ConfigureDialogue::fail(bool answered, std::uint32_t raw) noexcept {
  const Step& step = steps_[static_cast<std::size_t>(step_)];
  failed_ = true;
  failure_ = {static_cast<std::uint8_t>(step.reg), answered, value_of(step.reg, raw),
              value_of(step.reg, step.raw)};
}

void ConfigureDialogue::advance() noexcept {
  ++step_;
  attempts_ = 0;
  advanced_ = true;
}

}  // namespace limber
