// What a frame says, ready to be printed: who speaks, to whom, and values with units.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/can_frame.h"

namespace limber::bus_tools {

enum class Direction : std::uint8_t {
  kCommand,  ///< towards a drive, or to all
  kReply,    ///< from a drive, asked for or not
  kForeign,  ///< of nobody that robot.yaml knows
  kError,    ///< an adapter's message about its bus
};
const char* word_of(Direction direction);

struct Value {
  std::string name;  ///< may be empty
  std::string text;
  std::string unit;  ///< empty for plain numbers and words
};

struct Reading {
  std::string who;  ///< joint, with /2 for its second motor; "tip" for the sensor there; "all"
  Direction direction = Direction::kForeign;
  std::string what;  ///< "MIT command", "SDO read", ...
  std::vector<Value> values;
};

/// Five digits, as a person reads them.
std::string number(double value);
std::string hex(std::uint32_t value, int digits);
/// The data bytes, "01 0A FF".
std::string bytes(const CanFrame& frame);

/// "torque 1.5 N m, ...".
std::string text_of(const std::vector<Value>& values);

/// Reads the frames of one drive, sensor or service. It may remember earlier frames, so every frame
/// of the bus goes to every decoder until one knows it.
class FrameDecoder {
 public:
  virtual ~FrameDecoder() = default;
  /// Nothing if the frame is none of its own.
  virtual std::optional<Reading> read(const CanFrame& frame) = 0;
};

}  // namespace limber::bus_tools
