// The frames of each drive family in words, and as messages of a DBC file: one row a family.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "tools/can/dbc.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

struct DriveDecoders {
  std::string_view protocol;
  std::unique_ptr<FrameDecoder> (*make)(const Motor& motor, const BusFacts& bus);
  void (*add_messages)(const Motor& motor, const BusFacts& bus,
                       std::vector<dbc::Message>* messages);
  /// Of what is sent to all drives of the family on a bus. nullptr: nothing is, or make() has it.
  std::unique_ptr<FrameDecoder> (*make_network)(const std::vector<Motor>& motors) = nullptr;
  void (*add_network_messages)(const BusFacts& bus, std::vector<dbc::Message>* messages) = nullptr;
  /// Its drives look at a part of an identifier only: those that know all of it come first.
  bool last = false;
};

const DriveDecoders& decoders_of(const DriveConfig& drive);

}  // namespace limber::bus_tools
