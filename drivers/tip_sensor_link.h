// The driver's end of the force/torque sensor at the tip: one request a cycle, what came back, how
// old it is. It judges nothing: what a lost sensor means is the controller's business.
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/wrench_reading.h"
#include "robots/robot.h"

namespace limber {

/// Everything but the constructor is allowed inside the cycle.
class TipSensorLink {
 public:
  /// So many cycles in a row may go without a reading; more is an error until the next reading.
  TipSensorLink(const TipSensorConfig& sensor, int bridged_cycles)
      : sensor_(sensor), bridged_cycles_(bridged_cycles) {}

  /// This cycle's request.
  CanFrame next_frame() noexcept;
  /// Start of a cycle, after what came since the last one has been received.
  void begin_cycle() noexcept;
  /// The frame is on one of the sensor's reply identifiers.
  bool is_mine(int bus, const CanFrame& frame) const noexcept;
  /// A reading that comes too late for its cycle (`late`) is taken as well, and is a cycle old.
  void receive(const CanFrame& frame, bool late) noexcept;
  void close_cycle() noexcept {
    if (!fresh()) ++lost_;
  }

  bool fresh() const noexcept { return age_cycles_ == 0; }
  /// Nothing to wait for: it has answered, or has been silent for longer than is bridged.
  bool settled() const noexcept { return fresh() || age_cycles_ > bridged_cycles_; }
  /// joint_state_t SENSOR_*.
  std::int8_t state() const noexcept;
  /// Cycles since the last reading; kNever before the first.
  std::int32_t age_cycles() const noexcept { return age_cycles_; }
  static constexpr std::int32_t kNever = INT32_MAX;
  /// The last reading.
  const WrenchReading& reading() const noexcept { return reading_; }

  int bus() const noexcept { return sensor_.bus; }
  std::int32_t late() const noexcept { return late_; }
  std::int32_t lost() const noexcept { return lost_; }
  std::int32_t invalid() const noexcept { return invalid_; }

 private:
  bool decode(const CanFrame& frame, WrenchReading* reading) noexcept;

  TipSensorConfig sensor_;
  int bridged_cycles_;
  std::uint8_t counter_ = 0;  ///< of the last request
  bool half_ = false;         ///< the first of two frames is in first_
  CanFrame first_;
  WrenchReading reading_;
  std::int32_t age_cycles_ = kNever;
  std::int32_t late_ = 0;
  std::int32_t lost_ = 0;
  std::int32_t invalid_ = 0;
};

}  // namespace limber
