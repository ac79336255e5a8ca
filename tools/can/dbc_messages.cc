#include "tools/can/dbc_messages.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "drivers/protocols/mit.h"
#include "drivers/protocols/moteus.h"
#include "drivers/protocols/moteus_frame.h"
#include "tools/can/canopen_decoder.h"
#include "tools/can/damiao_decoder.h"
#include "tools/can/moteus_decoder.h"
#include "tools/can/motors_on_bus.h"

namespace limber::bus_tools {
namespace {

using dbc::Message;
using dbc::motorola_bit;
using dbc::Signal;

constexpr const char* kAll = "all";

Message message_of(const Motor& motor, const std::string& what, std::uint32_t id, bool fd,
                   int bytes, bool from_host) {
  Message message;
  message.id = id;
  message.extended = id > kStandardIdMax;
  message.fd = fd;
  message.node = motor.node;
  message.name = message.node + "_" + what;
  message.bytes = bytes;
  message.from_host = from_host;
  return message;
}

// --- Damiao --------------------------------------------------------------------------------------

/// -range to range; drives truncate, so that what they report is half a count more on average.
Signal symmetric(const char* name, int start, int bits, double range, const char* unit,
                 bool truncated = false) {
  Signal signal{name, start, bits, true};
  const double top = static_cast<double>((1U << static_cast<unsigned>(bits)) - 1U);
  signal.scale = 2.0 * range / top;
  signal.offset = -range + (truncated ? mit::half_count(range, bits) : 0.0);
  signal.low = -range;
  signal.high = range + (truncated ? mit::half_count(range, bits) : 0.0);
  signal.unit = unit;
  return signal;
}

Signal one_sided(const char* name, int start, double range, const char* unit) {
  Signal signal{name, start, 12, true};
  signal.scale = range / 4095.0;
  signal.high = range;
  signal.unit = unit;
  return signal;
}

/// All that an integer's bits can say.
void set_full_range(Signal* signal) {
  const double values = std::exp2(signal->bits);
  const double lowest = signal->is_signed ? -values / 2.0 : 0.0;
  signal->low = signal->offset + signal->scale * lowest;
  signal->high = signal->offset + signal->scale * (lowest + values - 1.0);
}

Signal plain(const char* name, int start, int bits, bool motorola, const char* unit = "") {
  Signal signal{name, start, bits, motorola};
  signal.unit = unit;
  set_full_range(&signal);
  return signal;
}

/// Whoever hears frames that are meant for all.
Motor all_nodes() {
  Motor all;
  all.name = all.node = kAll;
  return all;
}

void add_damiao(const Motor& motor, bool fd, std::vector<Message>* messages) {
  const DriveConfig& drive = motor.joint.drive;
  const CommandRange& range = drive.range;
  Message command = message_of(motor, "command", drive.command_id, fd, 8, true);
  command.comment =
      "MIT command. FF FF FF FF FF FF FF FC is enable, ..FD disable, ..FE set zero, ..FB clear "
      "error.";
  command.signals = {
      symmetric("position", motorola_bit(0, 7), 16, range.position_rad, "rad"),
      symmetric("velocity", motorola_bit(2, 7), 12, range.velocity_rad_per_s, "rad/s"),
      one_sided("kp", motorola_bit(3, 3), range.kp_Nm_per_rad, "N m/rad"),
      one_sided("kd", motorola_bit(5, 7), range.kd_Nms_per_rad, "N m s/rad"),
      symmetric("torque", motorola_bit(6, 3), 12, range.torque_Nm, "N m")};
  Message reply = message_of(motor, "state", drive.reply_id, fd, 8, false);
  reply.comment =
      "State before the command took effect. Answers to register requests (7FF) have the same "
      "identifier and another layout: id, 33 or 55, register, value.";
  Signal status = plain("status", motorola_bit(0, 7), 4, true);
  for (int i = 0; i < 16; ++i) {
    const std::string word = mit::error_text(static_cast<mit::DriveError>(i));
    if (!word.empty()) status.words.emplace_back(i, word);
  }
  reply.signals = {
      status,
      plain("id", motorola_bit(0, 3), 4, true),
      symmetric("position", motorola_bit(1, 7), 16, range.position_rad, "rad", true),
      symmetric("velocity", motorola_bit(3, 7), 12, range.velocity_rad_per_s, "rad/s", true),
      symmetric("torque", motorola_bit(4, 3), 12, range.torque_Nm, "N m", true),
      plain("T_mos", motorola_bit(6, 7), 8, true, "degC"),
      plain("T_rotor", motorola_bit(7, 7), 8, true, "degC")};
  messages->push_back(std::move(command));
  messages->push_back(std::move(reply));
}

Message damiao_registers(bool fd) {
  Message message = message_of(all_nodes(), "register", mit::kRegisterId, fd, 8, true);
  message.comment =
      "Register request to the motor with this id: its answer has the reply's identifier.";
  Signal operation = plain("operation", 16, 8, false);
  operation.words = {{0x33, "read"}, {0x55, "write"}, {0xAA, "store"}, {0xCC, "state request"}};
  message.signals = {plain("id", 0, 16, false), operation, plain("register", 24, 8, false),
                     plain("value", 32, 32, false)};
  return message;
}

// --- moteus --------------------------------------------------------------------------------------

/// The values that a frame writes or answers, where they lie in it.
std::vector<Signal> register_signals(const CanFrame& frame, moteus::Subframe::Kind kind) {
  std::vector<Signal> signals;
  moteus::FrameReader reader(frame);
  moteus::Subframe subframe;
  while (reader.next(&subframe)) {
    if (subframe.kind != kind) continue;
    const int bytes = moteus::size_of(subframe.type);
    for (unsigned i = 0; i < subframe.count; ++i) {
      const auto reg = static_cast<std::uint16_t>(subframe.first + i);
      const MoteusRegisterText text = moteus_register(reg);
      const auto byte =
          static_cast<int>(subframe.data - frame.data.data()) + bytes * static_cast<int>(i);
      Signal signal{dbc::identifier(text.name), 8 * byte, 8 * bytes};
      signal.is_float = subframe.type == moteus::Type::kFloat;
      signal.is_signed = true;
      signal.scale = moteus::lsb(reg, subframe.type);
      signal.unit = text.unit;
      if (!signal.is_float) set_full_range(&signal);
      signals.push_back(std::move(signal));
    }
  }
  return signals;
}

/// The answer to what a frame asks for, as drives lay it out: in the order of the request.
CanFrame answer_to(const CanFrame& request, std::uint32_t id) {
  moteus::FrameWriter answer(id);
  moteus::FrameReader reader(request);
  moteus::Subframe subframe;
  while (reader.next(&subframe)) {
    if (subframe.kind != moteus::Subframe::Kind::kRead) continue;
    const std::vector<double> zeros(subframe.count, 0.0);
    answer.reply(subframe.type, subframe.first, zeros);
  }
  return answer.frame();
}

void add_moteus(const Motor& motor, std::vector<Message>* messages) {
  const DriveConfig& drive = motor.joint.drive;
  const CanFrame command = moteus::encode_command({}, drive.command_id);
  const CanFrame answer = answer_to(command, drive.reply_id);
  Message to = message_of(motor, "command", drive.command_id, true, command.length, true);
  to.comment =
      "Limber's command in position mode. Other frames of this identifier are other rows of "
      "registers: stop is 01 00 00 and a request of the state.";
  to.signals = register_signals(command, moteus::Subframe::Kind::kWrite);
  Message from = message_of(motor, "state", drive.reply_id, true, answer.length, false);
  from.comment = "Answer to limber's command. Other requests have answers of another layout.";
  from.signals = register_signals(answer, moteus::Subframe::Kind::kReply);
  messages->push_back(std::move(to));
  messages->push_back(std::move(from));
}

// --- CANopen -------------------------------------------------------------------------------------

Message pdo_message(const Motor& motor, const Pdo& pdo, const DriveScale& scale, bool fd) {
  Message message = message_of(motor, pdo.name, pdo.cob_id, fd, 0, pdo.to_node);
  int bit = 0;
  for (const MappedObject& object : pdo.objects) {
    const ObjectRow row = object_row(object.id);
    Signal signal{dbc::identifier(row.name), bit, object.bits};
    signal.is_signed = is_signed(row.kind);
    signal.is_float = row.kind == ObjectKind::kFloat;
    signal.scale = scale.of(row.kind);
    signal.unit = row.unit;
    if (!signal.is_float) set_full_range(&signal);
    message.comment += (message.comment.empty() ? "" : ", ") + object_number(object.id);
    message.signals.push_back(std::move(signal));
    bit += object.bits;
  }
  const int bytes = (bit + 7) / 8;
  message.bytes = fd ? fd_length(bytes) : bytes;
  return message;
}

void add_canopen(const Motor& motor, bool fd, double period_s, std::vector<Message>* messages) {
  const CanopenDrive drive(motor, fd, period_s);
  for (const Pdo& pdo : drive.pdos.used())
    messages->push_back(pdo_message(motor, pdo, drive.scale, fd));
  Message emergency =
      message_of(motor, "EMCY", canopen::kEmergencyCode + drive.node, false, 8, false);
  emergency.signals = {plain("error_code", 0, 16, false), plain("error_register", 16, 8, false)};
  Message heartbeat =
      message_of(motor, "heartbeat", canopen::kHeartbeatCode + drive.node, false, 1, false);
  Signal state = plain("state", 0, 8, false);
  state.words = {{0, "boot-up"}, {4, "stopped"}, {5, "operational"}, {0x7F, "pre-operational"}};
  heartbeat.signals = {state};
  messages->push_back(std::move(emergency));
  messages->push_back(std::move(heartbeat));
}

Message network_management() {
  Message message = message_of(all_nodes(), "NMT", canopen::kNmtId, false, 2, true);
  Signal command = plain("command", 0, 8, false);
  command.words = {{1, "start"},
                   {2, "stop"},
                   {0x80, "enter pre-operational"},
                   {0x81, "reset node"},
                   {0x82, "reset communication"}};
  message.signals = {command, plain("node", 8, 8, false)};
  return message;
}

Message sync() { return message_of(all_nodes(), "SYNC", canopen::kSyncId, false, 0, true); }

// --- tip sensors ---------------------------------------------------------------------------------

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

/// A node's name that no other node has: "rot y" and "rot_y" are the same letters to a DBC file.
std::string take_node(const std::string& name, std::set<std::string>* taken) {
  const std::string wanted = dbc::identifier(name);
  std::string node = wanted;
  for (int number = 2; !taken->insert(node).second; ++number)
    node = fmt::format("{}_{}", wanted, number);
  return node;
}

void add_tip_sensor(const TipSensorConfig& sensor, const std::string& node,
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

}  // namespace

std::vector<Message> dbc_messages(const Robot& robot, int bus) {
  const bool fd = robot.buses[static_cast<std::size_t>(bus)].fd;
  std::vector<Message> messages;
  bool damiao = false;
  bool canopen_nodes = false;
  std::set<std::string> nodes = {"limber", kAll};  // the host, and what all hear
  auto motors = motors_on_bus(robot, bus);
  for (Motor& motor : motors) {
    motor.node = take_node(motor.name, &nodes);
    switch (motor.joint.drive.protocol) {
      case DriveProtocol::kDamiaoMit:
        damiao = true;
        add_damiao(motor, fd, &messages);
        break;
      case DriveProtocol::kMoteus:
        add_moteus(motor, &messages);
        break;
      case DriveProtocol::kCia402:
        canopen_nodes = true;
        add_canopen(motor, fd, 1.0 / robot.rate_hz, &messages);
        break;
    }
  }
  if (damiao) messages.push_back(damiao_registers(fd));
  if (canopen_nodes) {
    messages.push_back(network_management());
    messages.push_back(sync());
  }
  if (robot.has_tip_sensor && robot.tip_sensor.bus == bus)
    add_tip_sensor(robot.tip_sensor, take_node("tip", &nodes), &messages);
  return messages;
}

}  // namespace limber::bus_tools
