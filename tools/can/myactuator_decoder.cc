#include "tools/can/myactuator_decoder.h"

#include <array>

#include "drivers/protocols/myactuator.h"
#include "tools/can/mit_fields.h"

namespace limber::bus_tools {
namespace {

using myactuator::Order;

struct OrderRow {
  Order order;
  const char* name;
};
constexpr std::array kOrders = {
    OrderRow{Order::kFunction, "function"},    OrderRow{Order::kSetZero, "set zero"},
    OrderRow{Order::kReset, "reset"},          OrderRow{Order::kReleaseBrake, "release brake"},
    OrderRow{Order::kLockBrake, "lock brake"}, OrderRow{Order::kOff, "off"},
    OrderRow{Order::kAngle, "angle"},          OrderRow{Order::kStatus, "status"},
    OrderRow{Order::kVersion, "version"},      OrderRow{Order::kTimeout, "time-out"},
    OrderRow{Order::kModel, "model"},          OrderRow{Order::kTimedOut, "time-out is over"},
    OrderRow{Order::kBitRate, "bit rate"},
};

std::string name_of(std::uint8_t order) {
  for (const OrderRow& row : kOrders) {
    if (static_cast<std::uint8_t>(row.order) == order) return row.name;
  }
  return "order " + hex(order, 2);
}

std::vector<Value> values_of(const CanFrame& frame) {
  const std::string value = std::to_string(myactuator::value_of(frame));
  switch (static_cast<Order>(frame.data[0])) {
    case Order::kAngle:
      return {{"", number(myactuator::decode_angle(frame)), "rad"}};
    case Order::kStatus: {
      const myactuator::Status status = myactuator::decode_status(frame);
      const std::string errors = myactuator::errors_text(status.errors);
      return {{"", errors.empty() ? "no error" : errors, ""},
              {"brake", status.brake_released ? "released" : "locked", ""},
              {"supply", number(status.supply_V), "V"},
              {"T", std::to_string(status.temperature_degC), "degC"}};
    }
    case Order::kFunction:
      return {{std::to_string(frame.data[1]), value, ""}};
    case Order::kVersion:
      return {{"", value, ""}};
    case Order::kTimeout:
      return {{"", value, "ms"}};
    case Order::kModel: {
      myactuator::ModelText model;
      model.add(frame);
      return {{"", std::string(model.text()), ""}};
    }
    default:
      return {};
  }
}

}  // namespace

std::optional<Reading> MyactuatorDecoder::read(const CanFrame& frame) {
  const std::uint32_t number = drive_.command_id - myactuator::kMotionId;
  if (has_id(frame, myactuator::kOrderId + number)) return read_order(frame, Direction::kCommand);
  if (has_id(frame, myactuator::kAnswerId + number)) return read_order(frame, Direction::kReply);
  mit::Command command;
  mit::Reply reply;
  if (has_id(frame, drive_.command_id) && mit::decode_command(frame, drive_.range, &command))
    return Reading{name_, Direction::kCommand, "motion", mit_values(command)};
  if (has_id(frame, drive_.reply_id) && frame.data[0] == number &&
      mit::decode_reply(frame, drive_.range, &reply))
    return Reading{name_, Direction::kReply, "state", mit_values(reply, drive_.range)};
  const bool command_id = has_id(frame, drive_.command_id);
  if (!command_id && !has_id(frame, drive_.reply_id)) return std::nullopt;
  return Reading{name_,
                 command_id ? Direction::kCommand : Direction::kReply,
                 "unreadable",
                 {{"", bytes(frame), ""}}};
}

Reading MyactuatorDecoder::read_order(const CanFrame& frame, Direction direction) const {
  if (!myactuator::is_frame(frame, frame.id))
    return {name_, direction, "unreadable", {{"", bytes(frame), ""}}};
  const bool reads = myactuator::only_reads(frame.data[0]);
  const bool tells = reads == (direction == Direction::kReply);
  return {name_, direction, name_of(frame.data[0]),
          tells ? values_of(frame) : std::vector<Value>{}};
}

}  // namespace limber::bus_tools
