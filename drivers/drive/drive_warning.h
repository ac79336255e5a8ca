// What a drive should be looked at for while it goes on: it is warm, it warns, it has announced an
// error that is no fault.
#pragma once

#include <cstdint>

namespace limber {

/// One word, which another thread can be given at once.
struct alignas(8) DriveWarning {
  bool hot = false;             ///< above DriveConfig::warning_temperature_degC
  bool flagged = false;         ///< the drive's own warning bit
  std::uint16_t emergency = 0;  ///< code of an announced error; 0: none
  std::int8_t temperature_degC = 0;

  bool any() const noexcept { return hot || flagged || emergency != 0; }
  /// Another warning, whatever the temperature.
  bool differs(const DriveWarning& other) const noexcept {
    return hot != other.hot || flagged != other.flagged || emergency != other.emergency;
  }
};

/// Warm above the limit, and until 5 K below it: a temperature that sways about the limit is told
/// once. Allowed in the cycle.
class HeatWatch {
 public:
  explicit HeatWatch(double limit_degC) noexcept : limit_degC_(limit_degC) {}
  void add(double temperature_degC) noexcept {
    hot_ = temperature_degC > (hot_ ? limit_degC_ - kHysteresis_K : limit_degC_);
  }
  bool hot() const noexcept { return hot_; }

 private:
  static constexpr double kHysteresis_K = 5.0;
  double limit_degC_;
  bool hot_ = false;
};

}  // namespace limber
