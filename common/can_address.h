// The word a user changes to leave the simulator: which bus, and what carries it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace limber {

enum class CanCarrier : std::uint8_t {
  kVirtual,       ///< virtual:NAME, between processes of this machine
  kSocketCan,     ///< socketcan:INTERFACE, an adapter that the kernel drives
  kSlcan,         ///< slcan:/dev/NAME, LAWICEL's text protocol on a serial line
  kDamiaoSerial,  ///< dmserial:/dev/NAME, Damiao's adapter on a serial line
};

struct CanAddress {
  CanCarrier carrier;
  std::string place;  ///< NAME, INTERFACE or the device
  int baud = 0;       ///< of a serial line; behind an @ in the address, or the carrier's usual rate

  bool serial() const noexcept {
    return carrier == CanCarrier::kSlcan || carrier == CanCarrier::kDamiaoSerial;
  }
};

/// Nothing if it is none. Set-up only.
std::optional<CanAddress> can_address(const std::string& text);

/// For messages: all forms that an address can have.
inline constexpr std::string_view kCanAddressForms =
    "virtual:NAME, socketcan:INTERFACE, slcan:/dev/NAME or dmserial:/dev/NAME (with @BAUD behind a "
    "serial line that is no USB device)";

/// Only simulated motors can be there.
inline bool is_virtual(std::string_view address) noexcept {
  return address.starts_with("virtual:");
}

}  // namespace limber
