// One reading of a six-axis force/torque sensor, whatever the protocol.
#pragma once

#include <cstdint>

#include "robots/loader/tip_sensor_config.h"

#pragma GCC visibility push(default)
namespace limber {

struct WrenchReading {
  SixAxes F{};                ///< N and N m, sensor axes
  std::uint8_t overload = 0;  ///< a bit for each axis beyond its range: 0x20 Fx, ... 0x01 Tz
};

/// The bit of an axis, 0..5, in WrenchReading::overload.
constexpr std::uint8_t overload_bit(std::size_t axis) noexcept {
  return static_cast<std::uint8_t>(0x20U >> axis);
}

}  // namespace limber
#pragma GCC visibility pop
