// The register table of an emulated Damiao drive: values as the bus sees them, kept in RAM.
#pragma once

#include <array>
#include <cstdint>

#include "robots/loader/robot.h"

namespace limber::sim {

/// Power-up values come from the robot's description; TIMEOUT is 0 (no watchdog), as from the
/// factory, until a driver writes it. Registers the emulation has no use for answer with plausible
/// constants. Allowed in the cycle throughout.
class DamiaoRegisters {
 public:
  explicit DamiaoRegisters(const DriveConfig& drive, bool fd);

  /// Raw 32-bit content; 0 for numbers the drive does not have.
  std::uint32_t read(std::uint8_t reg) const noexcept;
  /// Takes the value if the register is writable and the value makes sense, else keeps the old one.
  /// Identifiers and bit rate stay as in the robot's description: the emulated node does not move
  /// on the bus.
  void write(std::uint8_t reg, std::uint32_t raw) noexcept;

  /// 0: no watchdog.
  std::int64_t timeout_ns() const noexcept;
  bool mit_mode() const noexcept;
  /// The ranges in which this drive packs and unpacks MIT frames.
  CommandRange range() const noexcept;

 private:
  static constexpr int kCount = 82;
  std::array<std::uint32_t, kCount> raw_{};
  CommandRange range_;
};

}  // namespace limber::sim
