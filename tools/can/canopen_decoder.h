// Frames of CANopen drives: one decoder a node, and one a bus for what is said to all of them.
//
// PDOs are read by their mapping: at first the one that limber's own start-up writes, then
// whatever a client is seen to write and the node to accept.
#pragma once

#include <map>

#include "tools/can/canopen_objects.h"
#include "tools/can/dbc.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/pdo_map.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

/// The mapping that limber's start-up gives this drive, and what its counts are worth.
struct CanopenDrive {
  CanopenDrive(const Motor& motor, bool fd, double period_s);

  std::uint8_t node;
  DriveScale scale;
  PdoMap pdos;
};

class CanopenDecoder final : public FrameDecoder {
 public:
  CanopenDecoder(const Motor& motor, bool fd, double period_s);
  std::optional<Reading> read(const CanFrame& frame) override;

 private:
  Reading read_pdo(const Pdo& pdo, const CanFrame& frame) const;
  Reading read_request(const canopen::SdoMessage& message);
  Reading read_answer(const canopen::SdoMessage& message);
  Reading reading(Direction direction, std::string what, std::vector<Value> values = {}) const {
    return {name_, direction, std::move(what), std::move(values)};
  }
  /// Number, name and value of the object.
  Value value(const canopen::SdoMessage& message) const;

  std::string name_;
  CanopenDrive drive_;
  std::optional<canopen::SdoMessage> open_write_;
};

/// Network management and SYNC.
class CanopenNetworkDecoder final : public FrameDecoder {
 public:
  explicit CanopenNetworkDecoder(const std::vector<Motor>& motors);
  std::optional<Reading> read(const CanFrame& frame) override;

 private:
  std::map<std::uint8_t, std::string> names_;  ///< of the nodes
};

void add_canopen_messages(const Motor& motor, const BusFacts& bus,
                          std::vector<dbc::Message>* messages);
/// Network management and SYNC.
void add_canopen_network_messages(const BusFacts& bus, std::vector<dbc::Message>* messages);

}  // namespace limber::bus_tools
