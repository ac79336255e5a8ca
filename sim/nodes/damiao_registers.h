// The register table of an emulated Damiao drive: values as the bus sees them, kept in RAM.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/protocols/mit.h"
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
  /// Takes the value if the register is writable and the value within the maker's range, else keeps
  /// the old one.
  void write(std::uint8_t reg, std::uint32_t raw) noexcept;

  /// Whether its bit rate is that of the robot's description, the emulated bus'.
  bool hears_the_bus() const noexcept;
  std::uint32_t id() const noexcept;        ///< ESC_ID
  std::uint32_t reply_id() const noexcept;  ///< MST_ID
  /// 0: no watchdog.
  std::int64_t timeout_ns() const noexcept;
  mit::ControlMode mode() const noexcept;
  double most_speed_rad_per_s() const noexcept;
  /// Of setpoints, rad/s^2; NaN: no limit.
  double acceleration_rad_per_s2() const noexcept;
  /// The ranges in which this drive packs and unpacks MIT frames.
  CommandRange range() const noexcept;

 private:
  static constexpr std::size_t kCount = 82;
  std::array<std::uint32_t, kCount> raw_{};
  CommandRange range_;
  std::uint32_t bus_rate_;
};

}  // namespace limber::sim
