// The command registers of an emulated moteus drive.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/protocols/moteus_registers.h"

namespace limber::sim {

/// Registers 0x020 to 0x029. NaN stands for "where it is", "as configured" or "none" where the
/// drive knows such a meaning; elsewhere what is not finite becomes the default. Allowed in the
/// cycle throughout.
class MoteusCommand {
 public:
  static bool has(std::uint16_t reg) noexcept { return reg >= kFirst && reg < kFirst + kCount; }

  double get(moteus::Register reg) const noexcept { return values_[index(reg)]; }
  double raw(std::uint16_t reg) const noexcept { return values_[reg - kFirst]; }
  void set(std::uint16_t reg, double value) noexcept;
  /// What a write of the mode does to all of them.
  void reset() noexcept { values_ = defaults(); }

 private:
  static constexpr std::uint16_t kFirst = 0x020;
  static constexpr std::size_t kCount = 10;
  using Values = std::array<double, kCount>;

  static std::size_t index(moteus::Register reg) noexcept {
    return static_cast<std::size_t>(reg) - kFirst;
  }
  static const Values& defaults() noexcept;

  Values values_ = defaults();
};

}  // namespace limber::sim
