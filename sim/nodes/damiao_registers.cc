#include "sim/nodes/damiao_registers.h"

#include <cmath>
#include <limits>

#include "drivers/protocols/mit.h"

namespace limber::sim {
namespace {

// Numbers beyond those in mit::Register, from the maker's manual.
enum : std::uint8_t {
  kUnderVoltage = 0,
  kTorqueConstant = 1,
  kOverTemperature = 2,
  kOverCurrent = 3,
  kAcceleration = 4,
  kDeceleration = 5,
  kMaxSpeed = 6,
  kMasterId = 7,
  kNodeId = 8,
  kRotorInertia = 12,
  kHardwareVersion = 13,
  kSoftwareVersion = 14,
  kGearRatio = 20,
  kCurrentBandwidth = 24,
  kFirstLoopGain = 25,
  kLastLoopGain = 28,
  kOverVoltage = 29,
  kGearEfficiency = 30,
  kSpeedDamping = 31,
  kSpeedBandwidth = 32,
  kCurrentEnhancement = 33,
  kSpeedEnhancement = 34,
  kBusRate = 35,
};

constexpr std::uint8_t kTimeout = static_cast<std::uint8_t>(mit::Register::kTimeout);
constexpr std::uint8_t kControlMode = static_cast<std::uint8_t>(mit::Register::kControlMode);
constexpr std::uint8_t kPositionRange = static_cast<std::uint8_t>(mit::Register::kPositionRange);
constexpr std::uint8_t kVelocityRange = static_cast<std::uint8_t>(mit::Register::kVelocityRange);
constexpr std::uint8_t kTorqueRange = static_cast<std::uint8_t>(mit::Register::kTorqueRange);

constexpr std::uint32_t kRate1M = 4;
constexpr std::uint32_t kRate5M = 9;

std::uint32_t bits(double value) { return mit::float_bits(static_cast<float>(value)); }

bool is_range(std::uint8_t reg) { return reg >= kPositionRange && reg <= kTorqueRange; }

/// What a register takes, ends included. MST_ID and ESC_ID must leave the registers' own id free.
struct RegisterRange {
  double least, greatest;
};
constexpr RegisterRange kReadOnly{1.0, 0.0};
constexpr double kLargest = 3.4e38;
constexpr double kTiny = 1e-30;

RegisterRange range_of(std::uint8_t reg) {
  if (reg >= kFirstLoopGain && reg <= kLastLoopGain) return {0.0, kLargest};
  switch (reg) {
    case kUnderVoltage:
      return {10.0, kLargest};
    case kTorqueConstant:
    case kOverVoltage:
    case kAcceleration:
      return {0.0, kLargest};
    case kOverTemperature:
      return {80.0, 200.0};
    case kOverCurrent:
    case kGearEfficiency:
      return {kTiny, 1.0};
    case kDeceleration:
      return {-kLargest, 0.0};
    case kMaxSpeed:
    case kPositionRange:
    case kVelocityRange:
    case kTorqueRange:
      return {kTiny, kLargest};
    case kMasterId:
      return {0.0, mit::kRegisterId - 1.0};
    case kNodeId:
      return {1.0, 0xFF};
    case kTimeout:
      return {0.0, kLargest};
    case kBusRate:
      return {0.0, kRate5M};
    case kControlMode:
      return {static_cast<double>(mit::ControlMode::kMit),
              static_cast<double>(mit::ControlMode::kForcePosition)};
    case kCurrentBandwidth:
    case kCurrentEnhancement:
      return {100.0, 1e4};
    case kSpeedDamping:
      return {1.0, 30.0};
    case kSpeedBandwidth:
      return {kTiny, 500.0};
    case kSpeedEnhancement:
      return {kTiny, 1e4};
    default:
      return kReadOnly;
  }
}

bool is_whole(std::uint8_t reg) {
  return (reg >= kMasterId && reg <= kControlMode) || reg == kBusRate;
}

}  // namespace

DamiaoRegisters::DamiaoRegisters(const DriveConfig& drive, bool fd)
    : range_(drive.range), bus_rate_(fd ? kRate5M : kRate1M) {
  raw_[kUnderVoltage] = bits(15.0);
  raw_[kTorqueConstant] = bits(drive.torque_constant_Nm_per_A / drive.gear_ratio);
  raw_[kOverTemperature] = bits(100.0);
  raw_[kOverCurrent] = bits(0.98);
  raw_[kMaxSpeed] = bits(drive.range.velocity_rad_per_s);
  raw_[kMasterId] = drive.reply_id;
  raw_[kNodeId] = drive.command_id;
  raw_[kControlMode] = static_cast<std::uint32_t>(mit::ControlMode::kMit);
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
  raw_[kSpeedDamping] = bits(4.0);
  raw_[kSpeedBandwidth] = bits(100.0);
  raw_[kCurrentEnhancement] = raw_[kSpeedEnhancement] = bits(1000.0);
  raw_[kBusRate] = bus_rate_;
}

std::uint32_t DamiaoRegisters::read(std::uint8_t reg) const noexcept {
  return reg < kCount ? raw_[reg] : 0;
}

void DamiaoRegisters::write(std::uint8_t reg, std::uint32_t raw) noexcept {
  const double value =
      is_whole(reg) ? static_cast<double>(raw) : static_cast<double>(mit::bits_float(raw));
  const RegisterRange range = range_of(reg);
  if (reg >= kCount || !(value >= range.least && value <= range.greatest)) return;
  if (is_range(reg)) {
    (reg == kPositionRange   ? range_.position_rad
     : reg == kVelocityRange ? range_.velocity_rad_per_s
                             : range_.torque_Nm) = value;
  }
  raw_[reg] = raw;
}

bool DamiaoRegisters::hears_the_bus() const noexcept { return raw_[kBusRate] == bus_rate_; }
std::uint32_t DamiaoRegisters::id() const noexcept { return raw_[kNodeId]; }
std::uint32_t DamiaoRegisters::reply_id() const noexcept { return raw_[kMasterId]; }

std::int64_t DamiaoRegisters::timeout_ns() const noexcept {
  return std::llround(raw_[kTimeout] * mit::kTimeoutCount_s * 1e9);
}

mit::ControlMode DamiaoRegisters::mode() const noexcept {
  return static_cast<mit::ControlMode>(raw_[kControlMode]);
}

double DamiaoRegisters::most_speed_rad_per_s() const noexcept {
  return static_cast<double>(mit::bits_float(raw_[kMaxSpeed]));
}

double DamiaoRegisters::acceleration_rad_per_s2() const noexcept {
  const auto value = static_cast<double>(mit::bits_float(raw_[kAcceleration]));
  return value > 0.0 ? value : std::numeric_limits<double>::quiet_NaN();
}

CommandRange DamiaoRegisters::range() const noexcept { return range_; }

}  // namespace limber::sim
