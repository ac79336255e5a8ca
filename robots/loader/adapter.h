// CAN adapters by class: what lies between a program and its bus.
#pragma once

#include <array>
#include <string_view>

#include "common/can_address.h"
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
  /// A frame takes so long on the adapter's own line, s, which may be slower than the bus.
  double line_out_s = 0.0;
  double line_in_s = 0.0;
};

inline constexpr double kDamiaoByte_s = 10.0 / 921'600;  ///< start, eight bits, stop
inline constexpr std::array<AdapterTiming, 4> kAdapters = {{
    {CanAdapter::kNative, "native", 20e-6, 20e-6, 10e-6, true},     // PCIe, or inside the processor
    {CanAdapter::kUsb, "usb", 75e-6, 100e-6, 75e-6, true},          // high-speed USB, 125 us frames
    {CanAdapter::kSlcan, "slcan", 500e-6, 1000e-6, 500e-6, false},  // text over a serial port
    // records of 30 and 16 bytes over a serial port
    {CanAdapter::kDamiaoSerial, "dmserial", 500e-6, 1000e-6, 500e-6, false, 30 * kDamiaoByte_s,
     16 * kDamiaoByte_s},
}};

constexpr const AdapterTiming& timing_of(CanAdapter adapter) noexcept {
  return kAdapters[static_cast<std::size_t>(adapter)];
}

/// The class that an address implies, or `otherwise`.
inline CanAdapter adapter_of(const std::string& address, CanAdapter otherwise) {
  const std::optional<CanAddress> found = can_address(address);
  if (!found || !found->serial()) return otherwise;
  return found->carrier == CanCarrier::kSlcan ? CanAdapter::kSlcan : CanAdapter::kDamiaoSerial;
}

}  // namespace limber
