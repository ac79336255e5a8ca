// What is read and written of ODrive's settings, by numbers that differ from firmware to firmware.
#pragma once

#include <array>
#include <cstdint>

namespace limber {

/// The order of DriveConfig::endpoints.
enum OdriveEndpoint {
  kOdriveState,
  kOdriveTimeout,
  kOdriveWatchdog,
  kOdriveEstimatesPeriod,
  kOdriveControlMode,
  kOdriveInputMode,
  kOdriveVelocityLimit
};
struct OdriveEndpointKind {
  const char* name;  ///< in robot.yaml, and the last word of the maker's path
  int bytes;
  bool real;  ///< float32
};
inline constexpr std::array kOdriveEndpoints = {
    OdriveEndpointKind{"current_state", 1, false},
    OdriveEndpointKind{"watchdog_timeout", 4, true},
    OdriveEndpointKind{"enable_watchdog", 1, false},
    OdriveEndpointKind{"encoder_msg_rate_ms", 4, false},
    OdriveEndpointKind{"control_mode", 1, false},
    OdriveEndpointKind{"input_mode", 1, false},
    OdriveEndpointKind{"vel_limit", 4, true},
};

/// Of firmware 0.6.`revision`; the first is 0: not known here.
std::array<std::uint16_t, kOdriveEndpoints.size()> odrive_endpoints(int revision) noexcept;

}  // namespace limber
