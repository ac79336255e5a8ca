// The driver's end of the force/torque sensor at the tip: one request a cycle, the last reading and
// its age. The motors go on without it; the controller decides what a lost sensor means.
#pragma once

#include <cstdint>
#include <limber/driver_status_t.hpp>
#include <limber/joint_state_t.hpp>
#include <vector>

#include "drivers/can/can_filter.h"
#include "drivers/can/can_frame.h"
#include "drivers/protocols/wrench_reading.h"
#include "robots/loader/robot.h"

namespace limber {

/// Everything but the constructor is allowed inside the cycle.
class TipSensorLink {
 public:
  /// So many cycles in a row may go without a reading; more is an error until the next reading.
  TipSensorLink(const TipSensorConfig& sensor, int bridged_cycles)
      : sensor_(sensor), bridged_cycles_(bridged_cycles) {}

  /// This cycle's request.
  CanFrame next_frame() noexcept;
  /// Start of a cycle, before what came since the last one is received.
  void begin_cycle() noexcept;
  /// The frame is on one of the sensor's reply identifiers.
  bool is_mine(std::size_t bus, const CanFrame& frame) const noexcept;
  /// The identifiers of is_mine(). Allocates: set-up only.
  void add_receive_filters(std::vector<CanFilter>* filters) const;
  /// A reading that comes too late for its cycle (`late`) is taken as well, and is a cycle old.
  void receive(const CanFrame& frame, bool late) noexcept;
  void close_cycle() noexcept {
    if (!fresh()) ++lost_;
  }

  bool fresh() const noexcept { return age_cycles_ == 0; }
  /// Nothing to wait for: it has answered, or has been silent for longer than is bridged.
  bool settled() const noexcept { return fresh() || age_cycles_ > bridged_cycles_; }

  /// Index into Robot::buses.
  std::size_t bus() const noexcept { return static_cast<std::size_t>(sensor_.bus); }

  void write_state(joint_state_t* state) const noexcept;
  void write_status(driver_status_t* status) const noexcept;

 private:
  static constexpr std::int32_t kNever = INT32_MAX;
  /// SENSOR_* of joint_state_t.
  std::int8_t state() const noexcept;
  bool decode(const CanFrame& frame, WrenchReading* reading) noexcept;

  TipSensorConfig sensor_;
  int bridged_cycles_;
  std::uint8_t counter_ = 0;  ///< of the last request
  bool half_ = false;         ///< the first of two frames is in first_
  CanFrame first_;
  WrenchReading reading_;
  std::int32_t age_cycles_ = kNever;  ///< since the last reading; kNever before the first
  std::int64_t late_ = 0;
  std::int64_t lost_ = 0;
  std::int64_t invalid_ = 0;
};

}  // namespace limber
