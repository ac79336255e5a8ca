// CAN adapters by class: what lies between a program and its bus.
#pragma once

#include <array>
#include <string_view>

#include "robots/loader/robot.h"

namespace limber {

/// Delay on top of the wire, s: `send` and `receive` always, `jitter` at most once more each way.
/// Typical figures, not measured here; a real adapter's round trip is printed by the driver's roll
/// call.
struct AdapterTiming {
  CanAdapter adapter;
  std::string_view word;  ///< `adapter:` of a bus in robot.yaml
  double send_s;
  double receive_s;
  double jitter_s;
  bool fd;
};

inline constexpr std::array<AdapterTiming, 3> kAdapters = {{
    {CanAdapter::kNative, "native", 20e-6, 20e-6, 10e-6, true},     // PCIe, or inside the processor
    {CanAdapter::kUsb, "usb", 75e-6, 100e-6, 75e-6, true},          // high-speed USB, 125 us frames
    {CanAdapter::kSlcan, "slcan", 500e-6, 1000e-6, 500e-6, false},  // text over a serial port
}};

constexpr const AdapterTiming& timing_of(CanAdapter adapter) noexcept {
  return kAdapters[static_cast<std::size_t>(adapter)];
}

}  // namespace limber
