#include "drivers/protocols/moteus_registers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace limber::moteus {
namespace {

/// Counts of int8, int16, int32.
struct Scale {
  double lsb[3];
};
constexpr Scale kPlain{{1.0, 1.0, 1.0}};
constexpr Scale kTurns{{0.01, 0.0001, 0.00001}};
constexpr Scale kTurnsPerS{{0.1, 0.00025, 0.00001}};
constexpr Scale kTurnsPerS2{{0.05, 0.001, 0.00001}};
constexpr Scale kNewtonMetre{{0.5, 0.01, 0.001}};
constexpr Scale kAmpereOrCelsius{{1.0, 0.1, 0.001}};
constexpr Scale kVolt{{0.5, 0.1, 0.001}};
constexpr Scale kSecond{{0.01, 0.001, 0.000001}};
constexpr Scale kShare{{1.0 / 127.0, 1.0 / 32767.0, 1.0 / 2147483647.0}};

const Scale& scale_of(std::uint16_t reg) noexcept {
  switch (static_cast<Register>(reg)) {
    case Register::kPosition:
    case Register::kAbsolutePosition:
    case Register::kCommandPosition:
    case Register::kCommandStopPosition:
    case Register::kSetOutputNearest:
    case Register::kSetOutputExact:
      return kTurns;
    case Register::kVelocity:
    case Register::kCommandVelocity:
    case Register::kCommandVelocityLimit:
      return kTurnsPerS;
    case Register::kCommandAccelerationLimit:
      return kTurnsPerS2;
    case Register::kTorque:
    case Register::kCommandTorque:
    case Register::kCommandMaxTorque:
    case Register::kTorqueP:
    case Register::kTorqueI:
    case Register::kTorqueD:
    case Register::kTorqueFeedForward:
    case Register::kTorqueTotal:
      return kNewtonMetre;
    case Register::kCurrentQ:
    case Register::kCurrentD:
    case Register::kMotorTemperature:
    case Register::kTemperature:
      return kAmpereOrCelsius;
    case Register::kVoltage:
      return kVolt;
    case Register::kCommandWatchdog:
      return kSecond;
    case Register::kCommandKpScale:
    case Register::kCommandKdScale:
      return kShare;
    default:
      return kPlain;
  }
}

constexpr std::int32_t greatest(Type type) noexcept {
  return static_cast<std::int32_t>((1LL << (8 * size_of(type) - 1)) - 1);
}

}  // namespace

const char* mode_text(int mode) noexcept {
  constexpr std::array kTexts = {"stopped",    "fault",       "enabling", "calibrating",
                                 "calibrated", "PWM",         "voltage",  "voltage FOC",
                                 "voltage DQ", "current",     "position", "time-out",
                                 "zero speed", "stay within", "",         "brake"};
  const bool known = mode >= 0 && mode < static_cast<int>(kTexts.size());
  return known ? kTexts[static_cast<std::size_t>(mode)] : "";
}

const char* fault_text(int fault) noexcept {
  constexpr int kFirst = 32;
  constexpr std::array kTexts = {
      "calibration",          "motor driver",
      "over-voltage",         "encoder",
      "motor not configured", "PWM cycle overrun",
      "over-temperature",     "outside the position limits",
      "under-voltage",        "configuration changed",
      "no valid angle",       "no valid position",
      "driver enabling",      "stop position deprecated",
      "timing violation",     "back-EMF feed-forward without an acceleration limit",
      "invalid limits",       "position error",
      "velocity error"};
  const int index = fault - kFirst;
  if (fault == 0) return "none";
  const bool known = index >= 0 && index < static_cast<int>(kTexts.size());
  return known ? kTexts[static_cast<std::size_t>(index)] : "";
}

double lsb(std::uint16_t reg, Type type) noexcept {
  return type == Type::kFloat ? 1.0 : scale_of(reg).lsb[static_cast<int>(type)];
}

std::int32_t to_integer(double value, double lsb, Type type) noexcept {
  const std::int32_t most = greatest(type);
  if (std::isnan(value)) return -most - 1;
  return static_cast<std::int32_t>(
      std::clamp(value / lsb, -static_cast<double>(most), static_cast<double>(most)));
}

double from_integer(std::int32_t raw, double lsb, Type type) noexcept {
  if (raw == -greatest(type) - 1) return std::numeric_limits<double>::quiet_NaN();
  return raw * lsb;
}

}  // namespace limber::moteus
