// What the numbers of moteus registers mean: names, number formats, scales (moteus reference,
// "CAN format" and "registers").
#pragma once

#include <cstdint>

#pragma GCC visibility push(default)
namespace limber::moteus {

/// Registers limber uses, and those an emulated drive answers for. Angles in turns of the output.
enum class Register : std::uint16_t {
  kMode = 0x000,
  kPosition = 0x001,
  kVelocity = 0x002,
  kTorque = 0x003,
  kCurrentQ = 0x004,
  kCurrentD = 0x005,
  kAbsolutePosition = 0x006,
  kMotorTemperature = 0x00A,
  kTrajectoryComplete = 0x00B,
  kHomeState = 0x00C,
  kVoltage = 0x00D,
  kTemperature = 0x00E,
  kFault = 0x00F,
  kCommandPosition = 0x020,  ///< NaN: where it is
  kCommandVelocity = 0x021,
  kCommandTorque = 0x022,  ///< feed-forward
  kCommandKpScale = 0x023,
  kCommandKdScale = 0x024,
  kCommandMaxTorque = 0x025,  ///< NaN: as configured
  kCommandStopPosition = 0x026,
  kCommandWatchdog = 0x027,  ///< s; 0: as configured, NaN: none
  kCommandVelocityLimit = 0x028,
  kCommandAccelerationLimit = 0x029,
  kTorqueP = 0x030,
  kTorqueI = 0x031,
  kTorqueD = 0x032,
  kTorqueFeedForward = 0x033,
  kTorqueTotal = 0x034,
  kAux1GpioStatus = 0x05E,
  kAux2GpioStatus = 0x05F,
  kMilliseconds = 0x070,
  kModel = 0x100,
  kFirmware = 0x101,
  kRegisterMap = 0x102,
  kId = 0x110,
  kSetOutputNearest = 0x130,
  kSetOutputExact = 0x131,
};
inline constexpr int kRegisterMapVersion = 5;

enum class Mode : std::uint8_t {
  kStopped = 0,
  kFault = 1,  ///< latched; only a stop leaves it
  kEnabling = 2,
  kCalibrating = 3,
  kCalibrationComplete = 4,
  kPosition = 10,
  kTimeout = 11,  ///< latched likewise
  kZeroVelocity = 12,
  kBrake = 15,
};
inline constexpr int kLastMode = 15;
/// "stopped" for a value of Register::kMode; empty for one that the maker does not list.
const char* mode_text(int mode) noexcept;
/// "over-voltage" for a value of Register::kFault; empty for one that the maker does not list.
const char* fault_text(int fault) noexcept;

/// Number formats, in the order of the two bits of an opcode.
enum class Type : std::uint8_t { kInt8 = 0, kInt16 = 1, kInt32 = 2, kFloat = 3 };

constexpr int size_of(Type type) noexcept {
  return type == Type::kInt8 ? 1 : type == Type::kInt16 ? 2 : 4;
}

/// What one count of an integer format is worth; 1 for plain numbers (modes, codes, counters) and
/// for float32.
double lsb(std::uint16_t reg, Type type) noexcept;

/// value = integer * lsb. Truncates towards zero and saturates at +-(2^(bits-1) - 1); NaN is the
/// most negative integer.
std::int32_t to_integer(double value, double lsb, Type type) noexcept;
double from_integer(std::int32_t raw, double lsb, Type type) noexcept;

}  // namespace limber::moteus
#pragma GCC visibility pop
