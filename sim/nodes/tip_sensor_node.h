// An emulated force/torque sensor: from the wrench it feels to the frames it sends.
//
//   felt -> first-order filter -> + bias + noise -> saturation -> resolution -> number format
//
// It answers every request at once, with the state before the request.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/types.h"
#include "drivers/can/can_frame.h"
#include "drivers/protocols/wrench_reading.h"

namespace limber::sim {

/// After construction every member is allowed in the cycle.
class TipSensorNode {
 public:
  explicit TipSensorNode(const TipSensorConfig& sensor) : sensor_(sensor) {}

  /// h seconds have passed, to simulated time `now`, and F is what the sensor feels: sensor axes,
  /// N and N m. The filter starts at the first value; y += (1 - exp(-h / tau)) (F - y).
  void update(const Vector6& F, double h, std::int64_t now_ns) noexcept;

  /// Handles a frame; the frames to send in answer, none if it is not a request for this node.
  /// The noise of an instant depends on seed and simulated time alone, not on what was requested
  /// before.
  std::span<const CanFrame> receive(const CanFrame& frame) noexcept;

  /// FAULT_SILENT until a simulated time.
  void silence(std::int64_t until_ns) noexcept { silent_until_ns_ = until_ns; }
  void clear_faults() noexcept { silent_until_ns_ = 0; }

 private:
  WrenchReading reading() const noexcept;

  TipSensorConfig sensor_;
  Vector6 filtered_ = Vector6::Zero();
  bool started_ = false;
  std::int64_t now_ns_ = 0;
  std::int64_t silent_until_ns_ = 0;
  std::array<CanFrame, 2> answer_;
};

}  // namespace limber::sim
