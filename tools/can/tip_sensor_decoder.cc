#include "tools/can/tip_sensor_decoder.h"

#include <array>
#include <utility>

#include "drivers/protocols/limber_ft.h"
#include "drivers/protocols/robotous_rft.h"

namespace limber::bus_tools {
namespace {

constexpr const char* kName = "tip";
constexpr std::array<const char*, 6> kAxes = {"Fx", "Fy", "Fz", "Tx", "Ty", "Tz"};

Reading from_sensor(std::string what, std::vector<Value> values) {
  return {kName, Direction::kReply, std::move(what), std::move(values)};
}

Reading unreadable_reply(const CanFrame& frame) {
  return from_sensor("unreadable", {{"", bytes(frame), ""}});
}

std::vector<Value> wrench_values(const WrenchReading& reading) {
  std::vector<Value> values;
  std::string overloaded;
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    values.push_back({kAxes[i], number(reading.F[i]), i < 3 ? "N" : "N m"});
    if ((reading.overload & overload_bit(i)) != 0)
      overloaded += (overloaded.empty() ? "" : " ") + std::string(kAxes[i]);
  }
  if (!overloaded.empty()) values.push_back({"OVERLOAD", overloaded, ""});
  return values;
}

}  // namespace

std::optional<Reading> TipSensorDecoder::read(const CanFrame& frame) {
  return sensor_.protocol == TipSensorProtocol::kLimberFt ? read_limber_ft(frame)
                                                          : read_robotous(frame);
}

std::optional<Reading> TipSensorDecoder::read_limber_ft(const CanFrame& frame) const {
  std::uint8_t counter = 0;
  if (has_id(frame, sensor_.command_id)) {
    if (limber_ft::decode_request(frame, sensor_.command_id, &counter))
      return Reading{
          kName, Direction::kCommand, "request", {{"counter", std::to_string(counter), ""}}};
    return Reading{kName, Direction::kCommand, "unreadable", {{"", bytes(frame), ""}}};
  }
  if (!has_id(frame, sensor_.reply_ids[0])) return std::nullopt;
  WrenchReading reading;
  if (!limber_ft::decode_reply(frame, &counter, &reading)) return unreadable_reply(frame);
  std::vector<Value> values = wrench_values(reading);
  values.push_back({"counter", std::to_string(counter), ""});
  return from_sensor("wrench", std::move(values));
}

std::optional<Reading> TipSensorDecoder::read_robotous(const CanFrame& frame) {
  if (has_id(frame, sensor_.command_id)) {
    const bool known = robotous_rft::decode_request(frame, sensor_.command_id);
    return Reading{kName, Direction::kCommand, known ? "request" : "other request",
                   known ? std::vector<Value>{} : std::vector<Value>{{"", bytes(frame), ""}}};
  }
  if (has_id(frame, sensor_.reply_ids[0])) {
    first_half_ = frame;
    return from_sensor("first half", {});
  }
  if (!has_id(frame, sensor_.reply_ids[1])) return std::nullopt;
  const std::optional<CanFrame> first = std::exchange(first_half_, std::nullopt);
  if (!first) return from_sensor("second half alone", {{"", bytes(frame), ""}});
  WrenchReading reading;
  if (!robotous_rft::decode_reply(*first, frame, {sensor_.counts_per_N, sensor_.counts_per_Nm},
                                  &reading))
    return unreadable_reply(frame);
  return from_sensor("wrench", wrench_values(reading));
}

}  // namespace limber::bus_tools
