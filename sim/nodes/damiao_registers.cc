#include "sim/nodes/damiao_registers.h"

#include <cmath>

#include "drivers/protocols/mit.h"

namespace limber::sim {
namespace {

// Numbers beyond those in mit::Register, from the maker's manual.
enum : std::uint8_t {
  kUnderVoltage = 0,
  kTorqueConstant = 1,
  kOverTemperature = 2,
  kOverCurrent = 3,
  kMaxSpeed = 6,
  kMasterId = 7,
  kNodeId = 8,
  kRotorInertia = 12,
  kHardwareVersion = 13,
  kSoftwareVersion = 14,
  kGearRatio = 20,
  kCurrentBandwidth = 24,
  kOverVoltage = 29,
  kGearEfficiency = 30,
  kBusRate = 35,
};

constexpr std::uint8_t kTimeout = static_cast<std::uint8_t>(mit::Register::kTimeout);
constexpr std::uint8_t kControlMode = static_cast<std::uint8_t>(mit::Register::kControlMode);
constexpr std::uint8_t kPositionRange = static_cast<std::uint8_t>(mit::Register::kPositionRange);
constexpr std::uint8_t kVelocityRange = static_cast<std::uint8_t>(mit::Register::kVelocityRange);
constexpr std::uint8_t kTorqueRange = static_cast<std::uint8_t>(mit::Register::kTorqueRange);

constexpr std::uint32_t kMitMode = 1;
constexpr std::uint32_t kLastMode = 4;
constexpr std::uint32_t kRate1M = 4;
constexpr std::uint32_t kRate5M = 9;

std::uint32_t bits(double value) { return mit::float_bits(static_cast<float>(value)); }

bool is_range(std::uint8_t reg) { return reg >= kPositionRange && reg <= kTorqueRange; }

bool writable(std::uint8_t reg) {
  const bool read_only = (reg >= 11 && reg <= 20) || reg >= 36;
  return !read_only && reg != kMasterId && reg != kNodeId && reg != kBusRate;
}

}  // namespace

DamiaoRegisters::DamiaoRegisters(const DriveConfig& drive, bool fd) : range_(drive.range) {
  raw_[kUnderVoltage] = bits(15.0);
  raw_[kTorqueConstant] = bits(drive.torque_constant_Nm_per_A / drive.gear_ratio);
  raw_[kOverTemperature] = bits(100.0);
  raw_[kOverCurrent] = bits(0.98);
  raw_[kMaxSpeed] = bits(drive.range.velocity_rad_per_s);
  raw_[kMasterId] = drive.reply_id;
  raw_[kNodeId] = drive.command_id;
  raw_[kControlMode] = kMitMode;
  raw_[kRotorInertia] = bits(drive.rotor_inertia_kgm2 / (drive.gear_ratio * drive.gear_ratio));
  raw_[kHardwareVersion] = 1;
  raw_[kSoftwareVersion] = 1;
  raw_[kGearRatio] = bits(drive.gear_ratio);
  raw_[kPositionRange] = bits(drive.range.position_rad);
  raw_[kVelocityRange] = bits(drive.range.velocity_rad_per_s);
  raw_[kTorqueRange] = bits(drive.range.torque_Nm);
  raw_[kCurrentBandwidth] = bits(1000.0);
  raw_[kOverVoltage] = bits(32.0);
  raw_[kGearEfficiency] = bits(1.0);
  raw_[kBusRate] = fd ? kRate5M : kRate1M;
}

std::uint32_t DamiaoRegisters::read(std::uint8_t reg) const noexcept {
  return reg < kCount ? raw_[reg] : 0;
}

void DamiaoRegisters::write(std::uint8_t reg, std::uint32_t raw) noexcept {
  if (reg >= kCount || !writable(reg)) return;
  if (reg == kControlMode && (raw < kMitMode || raw > kLastMode)) return;
  if (is_range(reg)) {
    const double value = mit::bits_float(raw);
    if (!(value > 0.0) || !std::isfinite(value)) return;
    (reg == kPositionRange   ? range_.position_rad
     : reg == kVelocityRange ? range_.velocity_rad_per_s
                             : range_.torque_Nm) = value;
  }
  raw_[reg] = raw;
}

std::int64_t DamiaoRegisters::timeout_ns() const noexcept {
  return std::llround(raw_[kTimeout] * mit::kTimeoutCount_s * 1e9);
}

bool DamiaoRegisters::mit_mode() const noexcept { return raw_[kControlMode] == kMitMode; }

CommandRange DamiaoRegisters::range() const noexcept { return range_; }

}  // namespace limber::sim
