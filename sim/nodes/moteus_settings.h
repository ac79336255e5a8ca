// What an emulated moteus drive is configured to, by the maker's names, and the commands that read
// and change it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "robots/loader/robot.h"
#include "sim/nodes/moteus_text.h"

namespace limber::sim {

/// In the order of their groups.
enum class Setting : std::uint8_t {
  kId,
  kTurnsPerRotorTurn,
  kKp,  ///< N m per turn
  kKi,
  kKd,  ///< N m per turn/s
  kDefaultTimeout,
  kTimeoutMode,
  kTimeoutTorque,
  kVelocityLimit,      ///< turns/s; NaN: none
  kAccelerationLimit,  ///< turns/s^2; NaN: none
  kFaultTemperature,   ///< degC
  kPositionMin,        ///< turns; NaN: none
  kPositionMax,
  kCount,
};

/// Only what the emulated drive honours is there, and only values that it honours are taken.
/// Allowed in the cycle throughout.
class MoteusSettings {
 public:
  MoteusSettings(const DriveConfig& drive, std::uint8_t id);

  double operator[](Setting setting) const noexcept { return values_[index(setting)]; }
  /// `conf` with get, set, enumerate, write, load, default.
  void command(std::string_view words, MoteusText* text) noexcept;

 private:
  static constexpr std::size_t kCount = static_cast<std::size_t>(Setting::kCount);
  using Values = std::array<double, kCount>;

  static std::size_t index(Setting setting) noexcept { return static_cast<std::size_t>(setting); }
  void enumerate(std::string_view group, MoteusText* text) const noexcept;
  void get(std::string_view name, MoteusText* text) const noexcept;
  void set(std::string_view words, MoteusText* text) noexcept;

  Values default_;
  Values stored_;
  Values values_;
};

}  // namespace limber::sim
