// The telemetry of an emulated moteus drive: what `tel` tells, as numbers with their schema or as
// text.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "sim/nodes/moteus_text.h"

namespace limber::sim {

/// The drive's own view of itself: turns of the output, N m, A.
struct MoteusStats {
  double model = 0.0;
  double firmware = 0.0;
  double id = 0.0;
  double mode = 0.0;
  double fault = 0.0;
  double position = 0.0;
  double velocity = 0.0;
  double torque_Nm = 0.0;
  double q_A = 0.0;
  double temperature_degC = 0.0;
  double voltage_V = 0.0;
  bool trajectory_done = false;
};

/// Channels firmware, git and servo_stats, on request only: nothing is sent periodically. Allowed
/// in the cycle throughout.
class MoteusTelemetry {
 public:
  static constexpr std::size_t kChannels = 3;

  /// `tel` with list, schema, get, fmt, text, stop.
  void command(std::string_view words, const MoteusStats& stats, MoteusText* text) noexcept;

 private:
  std::array<bool, kChannels> as_text_{};
};

}  // namespace limber::sim
