// What a drive should be looked at for while it goes on: it is warm, or too hot to be used further,
// it warns, it has announced an error that is no fault.
#pragma once

#include <cmath>
#include <cstdint>

namespace limber {

/// One word, which another thread can be given at once.
struct alignas(8) DriveWarning {
  static constexpr double kMost_degC = 1000.0;  ///< no drive is hotter, whatever it reports

  bool hot = false;             ///< above DriveConfig::warning_temperature_degC
  bool flagged = false;         ///< the drive's own warning bit
  std::uint16_t emergency = 0;  ///< code of an announced error; 0: none
  std::int16_t temperature_degC = 0;
  bool too_hot = false;  ///< above DriveConfig::limit_temperature_degC

  bool any() const noexcept { return hot || too_hot || flagged || emergency != 0; }
  /// Another warning, whatever the temperature.
  bool differs(const DriveWarning& other) const noexcept {
    return hot != other.hot || too_hot != other.too_hot || flagged != other.flagged ||
           emergency != other.emergency;
  }
};

/// Hot above the limit, and until 5 K below it: a temperature that sways about the limit is told
/// once. Either takes `readings` in a row; one that is not finite tells nothing. Allowed in the
/// cycle.
class HeatWatch {
 public:
  static constexpr double kHysteresis_K = 5.0;

  explicit HeatWatch(double limit_degC, int readings = 1) noexcept
      : limit_degC_(limit_degC), readings_(readings) {}
  void add(double temperature_degC) noexcept {
    if (!std::isfinite(temperature_degC)) return;
    const bool above = temperature_degC > (hot_ ? limit_degC_ - kHysteresis_K : limit_degC_);
    others_ = above == hot_ ? 0 : others_ + 1;
    if (others_ < readings_) return;
    hot_ = above;
    others_ = 0;
  }
  bool hot() const noexcept { return hot_; }

 private:
  double limit_degC_;
  int readings_;
  int others_ = 0;  ///< readings in a row that say otherwise
  bool hot_ = false;
};

}  // namespace limber
