// MyActuator drives (RMD-X) on CAN: orders of one byte under 140h + number, answered under 240h +
// number, and motion mode, the five numbers of a mini-cheetah frame, under 400h and 500h + number.
// Classic CAN, 11 bits, eight bytes; integers little-endian, the five numbers as in mit.h. Bytes
// only, both directions, no I/O, no state.
// Source: MyActuator, Servo Motor Control Protocol V4.2 of 2024-05; what V4.4 changed:
// github.com/almond-bot/axol, motor/myactuator.py, commit 3d3c09cb of 2026-08.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/mit.h"
#include "robots/loader/robot.h"

#pragma GCC visibility push(default)
namespace limber::myactuator {

inline constexpr int kLastMotor = 32;
// Identifiers; the first four are those of motor 0.
inline constexpr std::uint32_t kOrderId = 0x140;
inline constexpr std::uint32_t kAnswerId = 0x240;
inline constexpr std::uint32_t kMotionId = 0x400;
inline constexpr std::uint32_t kMotionAnswerId = 0x500;
inline constexpr std::uint32_t kEveryMotorId = 0x280;  ///< orders to all
inline constexpr std::uint32_t kSetNumberId = 0x300;   ///< gives all that hear it a number

/// First byte of an order and of its answer.
enum class Order : std::uint8_t {
  kFunction = 0x20,      ///< Function in byte 1, its value in 4 to 7
  kSetZero = 0x64,       ///< here; after a reset
  kReset = 0x76,         ///< about 1.1 s without an answer to anything, this order included
  kReleaseBrake = 0x77,  ///< answered when it is released: 50 to 150 ms (axol, pull request 45)
  kLockBrake = 0x78,
  kOff = 0x80,
  kAngle = 0x92,     ///< int32 in bytes 4 to 7, 0.01 degree
  kStatus = 0x9A,    ///< Status
  kVersion = 0xB2,   ///< uint32 in bytes 4 to 7: 2026042402 is 2026-04-24, the second
  kTimeout = 0xB3,   ///< uint32 in bytes 4 to 7, ms, 0: off; kept, and cannot be read
  kBitRate = 0xB4,   ///< byte 7, 0: 500 kbit/s, 1: 1 Mbit/s (2b-t/myactuator_rmd); kept
  kModel = 0xB5,     ///< text
  kTimedOut = 0xF1,  ///< from the drive, every second (myactuator_rmd_ros, pull request 4)
};
enum class Function : std::uint8_t {
  kTellErrors = 3,  ///< 1: a drive in error sends its status every 100 ms
  kSetNumber = 5,   ///< after a reset
};
/// Whether the order only reads.
bool only_reads(std::uint8_t order) noexcept;

CanFrame order_frame(Order order, int motor, std::uint32_t value = 0) noexcept;
CanFrame function_frame(Function function, int motor, std::uint32_t value) noexcept;
CanFrame bit_rate_frame(int motor, std::uint8_t code) noexcept;
/// The block-th (from 1) five letters of the model. Firmware of V4.2 ignores `block` and answers
/// with all of its seven.
CanFrame model_frame(int motor, int block) noexcept;
/// A classic data frame of eight bytes with this identifier.
bool is_frame(const CanFrame& frame, std::uint32_t id) noexcept;
/// Likewise, with this first byte under kAnswerId.
bool answers(const CanFrame& frame, Order order, int motor) noexcept;
/// Bytes 4 to 7.
std::uint32_t value_of(const CanFrame& frame) noexcept;
/// Of the answers to model_frame(), one after the other.
class ModelText {
 public:
  void add(const CanFrame& frame) noexcept;
  std::string_view text() const noexcept { return {letters_.data(), size_}; }
  /// 8 of "RMD-X8-P20"; 0 if there is none.
  int series() const noexcept;

 private:
  std::array<char, 14> letters_{};
  std::size_t size_ = 0;
};

/// The ranges of the five numbers depend on the firmware.
enum class Firmware : std::uint8_t { kUnknown, kV42, kV44 };
inline constexpr std::uint32_t kFirstV44 = 2026042402;
/// By its version date, of eight digits or of ten; kUnknown: no date, or one of eight digits that
/// may be either.
Firmware firmware_of(std::uint32_t version) noexcept;
/// That the ranges belong to: damping reaches to 5 N m s/rad in V4.2, to 50 from V4.4 on.
Firmware firmware_of(const CommandRange& range) noexcept;
/// "V4.4"
const char* name_of(Firmware firmware) noexcept;

/// State in answer to a motion command, from before it took effect.
struct Motion {
  std::uint8_t motor = 0;
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double torque_Nm = 0.0;
};
CanFrame encode_motion(const Motion& motion, const CommandRange& range,
                       mit::Quantiser quantiser) noexcept;
[[nodiscard]] bool decode_motion(const CanFrame& frame, const CommandRange& range,
                                 Motion* motion) noexcept;

enum Error : std::uint16_t { kUnderVoltage = 0x0004 };
struct Status {
  int temperature_degC = 0;
  bool brake_released = false;
  double supply_V = 0.0;
  std::uint16_t errors = 0;
};
CanFrame encode_status(const Status& status, int motor) noexcept;
/// Of a frame that answers kStatus.
Status decode_status(const CanFrame& frame) noexcept;
/// "under-voltage, motor too hot"; empty if there is none. Allocates.
std::string errors_text(std::uint16_t errors);

CanFrame encode_angle(double angle_rad, int motor) noexcept;
/// Of a frame that answers kAngle.
double decode_angle(const CanFrame& frame) noexcept;

}  // namespace limber::myactuator
#pragma GCC visibility pop
