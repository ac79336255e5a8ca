// What robot.yaml's loader, the bus load and the driver know of a tip sensor's protocol: one row a
// protocol. Data only.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace limber {

enum class TipSensorProtocol : std::uint8_t {
  kRobotousRft,  ///< Robotous RFT series, classic CAN, 16-bit counts (drivers/protocols)
  kLimberFt,     ///< limber's own, one CAN-FD frame of float32
};

struct TipSensorTraits {
  TipSensorProtocol protocol;
  std::string_view word;  ///< `protocol:` of the tip sensor in robot.yaml
  bool fd;                ///< FD frames; else classic ones
  bool counts;            ///< readings are 16-bit counts, scaled as set in the sensor
  int replies;            ///< frames with an identifier each, for one request
  int request_bytes;
  int reply_bytes;  ///< of each
};

inline constexpr std::array kTipSensorProtocols = {
    TipSensorTraits{TipSensorProtocol::kRobotousRft, "robotous_rft", false, true, 2, 8, 8},
    TipSensorTraits{TipSensorProtocol::kLimberFt, "limber_ft", true, false, 1, 2, 32},
};

static_assert(kTipSensorProtocols[0].protocol == TipSensorProtocol::kRobotousRft &&
                  kTipSensorProtocols[1].protocol == TipSensorProtocol::kLimberFt,
              "rows in the order of the enumeration");

constexpr const TipSensorTraits& traits_of(TipSensorProtocol protocol) noexcept {
  return kTipSensorProtocols[static_cast<std::size_t>(protocol)];
}

}  // namespace limber
