// The drive profile CiA 402 in cyclic synchronous torque mode: its objects and its state machine as
// data. Pure numbers; everything is allowed in the cycle. Angles, speeds and torques are the
// drive's own, before joint sign and offset. The PDOs are in cia402_pdos.h.
//
//   torque [N m]   = thousandths / 1000 * rated torque, 6076h in mN m
//   current [A]    = thousandths / 1000 * rated current, 6075h in mA
//   angle [rad]    = 2 pi counts / counts per joint revolution
//   speed [rad/s]  likewise, of counts/s
//   counts per joint revolution = (608Fh:01 / 608Fh:02) * (6091h:01 / 6091h:02); link encoder
//   60E6h:01
#pragma once

#include <cstdint>

#include "drivers/protocols/canopen.h"

#pragma GCC visibility push(default)
namespace limber::cia402 {

using canopen::Object;

// --- objects -------------------------------------------------------------------------------------

inline constexpr Object kErrorCode = {{0x603F, 0}, 2};
inline constexpr Object kControlword = {{0x6040, 0}, 2};
inline constexpr Object kStatusword = {{0x6041, 0}, 2};
inline constexpr Object kQuickStopOption = {{0x605A, 0},
                                            2};  ///< i16; 1..4 ends disabled, 5..8 stays
inline constexpr Object kShutdownOption = {{0x605B, 0}, 2};        ///< i16
inline constexpr Object kDisableOption = {{0x605C, 0}, 2};         ///< i16
inline constexpr Object kHaltOption = {{0x605D, 0}, 2};            ///< i16
inline constexpr Object kFaultOption = {{0x605E, 0}, 2};           ///< i16
inline constexpr Object kConnectionLostOption = {{0x6007, 0}, 2};  ///< i16, Reaction
inline constexpr Object kMode = {{0x6060, 0}, 1};                  ///< i8, wanted
inline constexpr Object kModeInForce = {{0x6061, 0}, 1};           ///< i8
inline constexpr Object kPosition = {{0x6064, 0}, 4};              ///< i32, motor counts
inline constexpr Object kVelocity = {{0x606C, 0}, 4};              ///< i32, motor counts/s
inline constexpr Object kTargetTorque = {{0x6071, 0}, 2};          ///< i16, thousandths
inline constexpr Object kMaxTorque = {{0x6072, 0}, 2};             ///< u16, thousandths
inline constexpr Object kTorqueDemand = {{0x6074, 0}, 2};          ///< i16, after the limits
inline constexpr Object kRatedCurrent_mA = {{0x6075, 0}, 4};       ///< u32
inline constexpr Object kRatedTorque_mNm = {{0x6076, 0}, 4};       ///< u32
/// i16, thousandths: sensed on the link if the joint has a torque sensor, else of the current.
inline constexpr Object kTorqueActual = {{0x6077, 0}, 2};
inline constexpr Object kCurrentActual = {{0x6078, 0}, 2};  ///< i16, thousandths
/// u32: so many counts in so many revolutions of the motor.
inline constexpr Object kEncoderCounts = {{0x608F, 1}, 4};
inline constexpr Object kEncoderTurns = {{0x608F, 2}, 4};
/// u32, optional: so many revolutions of the motor in so many of the joint.
inline constexpr Object kGearMotorTurns = {{0x6091, 1}, 4};
inline constexpr Object kGearJointTurns = {{0x6091, 2}, 4};
inline constexpr Object kSupply_mV = {{0x6079, 0}, 4};     ///< u32, DC link
inline constexpr Object kTorqueOffset = {{0x60B2, 0}, 2};  ///< i16, added to the target
/// u8, i8: cycle time = :01 * 10^:02 s.
inline constexpr Object kCyclePeriod = {{0x60C2, 1}, 1};
inline constexpr Object kCyclePeriodExponent = {{0x60C2, 2}, 1};
// Only in drives with a link encoder; CiA 402 calls it the first additional position sensor.
inline constexpr Object kLinkPosition = {{0x60E4, 1}, 4};       ///< i32, link counts
inline constexpr Object kLinkEncoderCounts = {{0x60E6, 1}, 4};  ///< u32, per joint revolution
inline constexpr Object kDigitalInputs = {{0x60FD, 0}, 4};      ///< u32
inline constexpr Object kSupportedModes = {{0x6502, 0}, 4};     ///< u32, bit mode - 1

// limber's own (manufacturer area). Joint torque loop with ratio rho of motor inertia to apparent
// inertia, tau_m = rho u + (1 - rho)(tau + D_J / K_J tau'). Drives without a torque sensor have
// rho = 1, and refuse any other value.
inline constexpr Object kInertiaRatio = {{0x2010, 1}, 4};                ///< float32, rho
inline constexpr Object kSpringStiffness_Nm_per_rad = {{0x2010, 2}, 4};  ///< float32, K_J
inline constexpr Object kSpringDamping_Nms_per_rad = {{0x2010, 3}, 4};   ///< float32, D_J
inline constexpr Object kTorqueLoopRate_Hz = {{0x2010, 4}, 4};           ///< u32, read only
inline constexpr Object kTorqueLoopDelay_us = {{0x2010, 5}, 4};          ///< u32, read only
inline constexpr Object kCurrentLoopLag_us = {{0x2011, 1}, 4};           ///< u32, read only
/// i32, link counts/s; only in drives with a link encoder.
inline constexpr Object kLinkVelocity = {{0x2069, 0}, 4};

inline constexpr std::int8_t kCyclicSynchronousTorque = 10;

/// What a drive does when its master is lost (6007h).
enum class Reaction : std::int16_t {
  kNothing = 0,
  kFault = 1,
  kDisableVoltage = 2,
  kQuickStop = 3,
};

// --- state machine -------------------------------------------------------------------------------

enum class State : std::uint8_t {
  kNotReady,
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReactionActive,
  kFault,
};
inline constexpr int kStates = 8;

/// Commands of a controlword; a fault reset is the rising edge of its bit.
enum class Command : std::uint8_t {
  kNone,
  kShutdown,
  kSwitchOn,  ///< also "disable operation"
  kEnableOperation,
  kDisableVoltage,
  kQuickStop,
  kFaultReset,
};

// Controlwords that give the commands.
inline constexpr std::uint16_t kShutdown = 0x0006;
inline constexpr std::uint16_t kSwitchOn = 0x0007;
inline constexpr std::uint16_t kEnableOperation = 0x000F;
inline constexpr std::uint16_t kDisableVoltage = 0x0000;
inline constexpr std::uint16_t kQuickStop = 0x0002;
inline constexpr std::uint16_t kFaultReset = 0x0080;

// Bits of a statusword beside the state.
inline constexpr std::uint16_t kVoltagePresent = 1U << 4U;
inline constexpr std::uint16_t kWarning = 1U << 7U;
inline constexpr std::uint16_t kRemote = 1U << 9U;
inline constexpr std::uint16_t kTargetReached = 1U << 10U;
inline constexpr std::uint16_t kLimitActive = 1U << 11U;
inline constexpr std::uint16_t kFollowing = 1U << 12U;  ///< cyclic modes: executes its target

/// Every statusword is of one state; those the profile does not list count as not ready.
State state_of(std::uint16_t statusword) noexcept;
/// The state's own bits of a statusword.
std::uint16_t statusword_of(State state) noexcept;
/// The command of a controlword that follows `previous`.
Command command_of(std::uint16_t controlword, std::uint16_t previous) noexcept;
/// The state a command leads to; the present one if the command is none for it. With
/// `enable_after_quick_stop` (605Ah 5 to 8) a quick stop can be left towards enabled.
State next_state(State state, Command command, bool enable_after_quick_stop) noexcept;
/// The controlword that brings a drive one state nearer to operation enabled, and keeps it there.
/// In fault: disable voltage, after which kFaultReset is an edge.
std::uint16_t towards_enabled(State state) noexcept;
const char* name_of(State state) noexcept;

// --- units ---------------------------------------------------------------------------------------

/// Nearest thousandth of `rated`, within what 16 bits hold (NaN: 0).
std::int16_t to_permille(double value, double rated) noexcept;
double from_permille(std::int16_t permille, double rated) noexcept;

}  // namespace limber::cia402
#pragma GCC visibility pop
