// The private protocol of RobStride drives (and of the CyberGear), as they are delivered: classic
// CAN, 29-bit identifiers with the frame's type and sixteen bits of data in them, eight bytes.
// Bytes only, both directions, no I/O, no state. Angles, speeds and torques are the drive's own.
// Source: RobStride's manuals of 2026-04.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/mit.h"
#include "robots/loader/robot.h"

#pragma GCC visibility push(default)
namespace limber::robstride {

/// Bits 28 to 24 of an identifier.
enum class Type : std::uint8_t {
  kPing = 0,  ///< and its answer, which goes to kEverybody
  kControl = 1,
  kState = 2,
  kEnable = 3,
  kStop = 4,  ///< with kClear as its first byte faults are cleared
  kSetZero = 6,
  kSetId = 7,
  kRead = 17,
  kWrite = 18,
  kFault = 21,  ///< of the drive, without a request
  kSave = 22,
  kSetBaud = 23,
  kReport = 24,  ///< on or off; and a state that comes without a request
  kSetProtocol = 25,
};
inline constexpr std::uint8_t kHost = 0xFD;  ///< the driver's number, by custom
inline constexpr std::uint8_t kEverybody = 0xFE;
inline constexpr std::uint8_t kLastMotor = 0x7F;
inline constexpr std::uint8_t kClear = 1;

/// An identifier: type << 24 | data << 8 | target.
struct Id {
  Type type;
  std::uint16_t data;
  std::uint8_t target;
};
std::uint32_t to_number(const Id& id) noexcept;
/// False unless the frame is a classic data frame of eight bytes with 29 bits of identifier.
[[nodiscard]] bool split(const CanFrame& frame, Id* id) noexcept;
/// A frame of the host to the motor: its sixteen bits are the host's number.
CanFrame request(Type type, std::uint8_t motor) noexcept;

using mit::Command;  // the same five numbers

enum class Mode : std::uint8_t { kReset = 0, kCalibration = 1, kRun = 2 };
/// Bits of State::faults, from 0: under-voltage, over-current, over-temperature, encoder, stall or
/// overload, not calibrated.
inline constexpr int kFaults = 6;
enum Fault : std::uint8_t { kUnderVoltage = 1, kOverCurrent = 2, kOverTemperature = 4 };
/// "over-current"; bit 0 to kFaults - 1.
const char* fault_text(int bit) noexcept;
/// Those of State::faults, "over-current, encoder error"; empty if there is none. Allocates.
std::string faults_text(std::uint8_t faults);

struct State {
  std::uint8_t motor = 0;
  std::uint8_t host = kHost;
  Mode mode = Mode::kReset;
  std::uint8_t faults = 0;
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double torque_Nm = 0.0;
  double temperature_degC = 0.0;
};

// Fields span -range to +range in 65535 counts, 32767 of them zero; gains 0 to range in 65536.
// Values outside saturate; commands are rounded, states truncated, as drives do. NaN, or a range
// that is none, gives false and leaves the frame alone.
[[nodiscard]] bool encode_command(const Command& command, const CommandRange& range,
                                  std::uint8_t motor, CanFrame* frame) noexcept;
[[nodiscard]] bool decode_command(const CanFrame& frame, const CommandRange& range,
                                  Command* command) noexcept;
/// `type`: kState or kReport.
CanFrame encode_state(const State& state, const CommandRange& range, Type type) noexcept;
/// Of either type. False if the frame is neither.
[[nodiscard]] bool decode_state(const CanFrame& frame, const CommandRange& range,
                                State* state) noexcept;
/// The torque of one count.
double torque_count_Nm(const CommandRange& range) noexcept;

// What has data of its own beside the type.
CanFrame encode_clear(std::uint8_t motor) noexcept;
CanFrame encode_set_zero(std::uint8_t motor) noexcept;
CanFrame encode_set_id(std::uint8_t motor, std::uint8_t wanted) noexcept;
CanFrame encode_save(std::uint8_t motor) noexcept;
/// `code`: 1 to 4 for 1000, 500, 250 and 125 kbit/s, from the next power-up on.
CanFrame encode_set_baud(std::uint8_t motor, std::uint8_t code) noexcept;
/// Switches states without a request on or off.
CanFrame encode_report(std::uint8_t motor, bool on) noexcept;
/// Of a motor, to a ping or a new number.
CanFrame encode_presence(std::uint8_t motor, std::uint64_t unique) noexcept;

/// Indices of parameters; little-endian in the frame.
enum class Parameter : std::uint16_t {
  kRunMode = 0x7005,       ///< uint8, 0: control (the five numbers)
  kPosition = 0x7019,      ///< float32, rad
  kVelocity = 0x701B,      ///< float32, rad/s
  kVoltage = 0x701C,       ///< float32, V
  kReportPeriod = 0x7026,  ///< uint16, 1: 10 ms, 5 ms a count
  kTimeout = 0x7028,       ///< uint32, counts of 50 us; 0: off, as delivered
  kZeroAtStart = 0x7029,   ///< uint8, 1: -pi to pi at power-up
};
inline constexpr double kTimeoutCount_s = 50e-6;

CanFrame encode_read(std::uint8_t motor, std::uint16_t index) noexcept;
CanFrame encode_write(std::uint8_t motor, std::uint16_t index, std::uint32_t raw) noexcept;
struct ParameterRequest {
  bool write = false;
  std::uint16_t index = 0;
  std::uint32_t raw = 0;
};
[[nodiscard]] bool decode_parameter_request(const CanFrame& frame,
                                            ParameterRequest* request) noexcept;
struct ParameterAnswer {
  std::uint8_t motor = 0;
  std::uint8_t host = kHost;
  bool refused = false;  ///< the value is 0 then, and means nothing
  std::uint16_t index = 0;
  std::uint32_t raw = 0;
};
CanFrame encode_parameter_answer(const ParameterAnswer& answer) noexcept;
[[nodiscard]] bool decode_parameter_answer(const CanFrame& frame, ParameterAnswer* answer) noexcept;

/// Of type kFault: both words of bits.
struct FaultReport {
  std::uint32_t faults = 0;
  std::uint32_t warnings = 0;
};
CanFrame encode_fault(std::uint8_t motor, std::uint8_t host, const FaultReport& report) noexcept;
[[nodiscard]] bool decode_fault(const CanFrame& frame, FaultReport* report) noexcept;
/// "stall"; empty for a bit (0 to 31) that the manuals do not list.
const char* reported_fault_text(int bit) noexcept;

}  // namespace limber::robstride
#pragma GCC visibility pop
