// An emergency stop that is heard on a bus, as robot.yaml describes it.
#pragma once

#include <cstdint>

namespace limber {

/// A digital input on the bus (a CANopen I/O module's TPDO, a safety relay's monitor) that sends
/// its state by itself, again and again.
struct EmergencyStopConfig {
  int bus = 0;  ///< index into Robot::buses
  std::uint32_t id = 0;
  int byte = 0;               ///< of the frame's data
  std::uint8_t mask = 1;      ///< bits that count
  std::uint8_t released = 1;  ///< what they are while nobody presses it
  double timeout_s = 0.1;     ///< without a frame for so long it counts as pressed
  double power_off_s = 0.5;   ///< the drives hold for so long, then they are disabled
};

}  // namespace limber
