#include <array>

#include "robots/loader/protocols/tip_sensor_protocol.h"
#include "tools/can/dbc_signals.h"
#include "tools/can/tip_sensor_decoder.h"

namespace limber::bus_tools {
namespace {

using dbc::Message;
using dbc::motorola_bit;
using dbc::Signal;

constexpr std::array<const char*, 6> kTipAxes = {"Fx", "Fy", "Fz", "Tx", "Ty", "Tz"};

Signal axis_signal(std::size_t axis, int start, int bits, const TipSensorConfig& sensor) {
  Signal signal{kTipAxes[axis], start, bits};
  signal.unit = axis < 3 ? "N" : "N m";
  signal.is_signed = true;
  signal.low = -sensor.range[axis];
  signal.high = sensor.range[axis];
  return signal;
}

Message limber_ft_reply(const Motor& tip, const TipSensorConfig& sensor) {
  Message message = message_of(tip, "wrench", sensor.reply_ids[0], true, 32, false);
  message.signals = {plain("counter", 8, 8, false), plain("overload", 16, 8, false)};
  for (std::size_t i = 0; i < kTipAxes.size(); ++i) {
    Signal signal = axis_signal(i, 32 + 32 * static_cast<int>(i), 32, sensor);
    signal.is_float = true;
    message.signals.push_back(std::move(signal));
  }
  return message;
}

/// Both halves; Tx lies astride them, which no DBC can say.
std::array<Message, 2> robotous_replies(const Motor& tip, const TipSensorConfig& sensor) {
  std::array<Message, 2> halves = {
      message_of(tip, "wrench_1", sensor.reply_ids[0], false, 8, false),
      message_of(tip, "wrench_2", sensor.reply_ids[1], false, 8, false)};
  halves[0].comment = halves[1].comment =
      "Tx is left out: its upper byte is the last one of the first frame, its lower byte the first "
      "one of the second";
  for (std::size_t i = 0; i < kTipAxes.size(); ++i) {
    const int byte = 1 + 2 * static_cast<int>(i);
    if (byte == 7) continue;
    Signal signal = axis_signal(i, motorola_bit(byte % 8, 7), 16, sensor);
    signal.motorola = true;
    signal.scale = 1.0 / (i < 3 ? sensor.counts_per_N : sensor.counts_per_Nm);
    halves[byte < 8 ? 0 : 1].signals.push_back(std::move(signal));
  }
  halves[1].signals.push_back(plain("overload", motorola_bit(5, 7), 8, true));
  return halves;
}

}  // namespace

void add_tip_sensor_messages(const TipSensorConfig& sensor, const std::string& node,
                             std::vector<Message>* messages) {
  Motor tip;
  tip.name = "tip";
  tip.node = node;
  const TipSensorTraits& traits = traits_of(sensor.protocol);
  Message request =
      message_of(tip, "request", sensor.command_id, traits.fd, traits.request_bytes, true);
  if (sensor.protocol == TipSensorProtocol::kLimberFt)
    request.signals = {plain("counter", 8, 8, false)};
  messages->push_back(std::move(request));
  if (sensor.protocol == TipSensorProtocol::kLimberFt) {
    messages->push_back(limber_ft_reply(tip, sensor));
  } else {
    for (Message& half : robotous_replies(tip, sensor)) messages->push_back(std::move(half));
  }
}

}  // namespace limber::bus_tools
