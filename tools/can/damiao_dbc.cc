#include "tools/can/damiao_decoder.h"
#include "tools/can/dbc_signals.h"

namespace limber::bus_tools {
namespace {

using dbc::Message;
using dbc::motorola_bit;
using dbc::Signal;

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

}  // namespace

void add_damiao_messages(const Motor& motor, const BusFacts& bus, std::vector<Message>* messages) {
  const DriveConfig& drive = motor.joint.drive;
  const CommandRange& range = drive.range;
  Message command = message_of(motor, "command", drive.command_id, bus.fd, 8, true);
  command.comment =
      "MIT command. FF FF FF FF FF FF FF FC is enable, ..FD disable, ..FE set zero, ..FB clear "
      "error.";
  command.signals = {
      symmetric("position", motorola_bit(0, 7), 16, range.position_rad, "rad"),
      symmetric("velocity", motorola_bit(2, 7), 12, range.velocity_rad_per_s, "rad/s"),
      one_sided("kp", motorola_bit(3, 3), range.kp_Nm_per_rad, "N m/rad"),
      one_sided("kd", motorola_bit(5, 7), range.kd_Nms_per_rad, "N m s/rad"),
      symmetric("torque", motorola_bit(6, 3), 12, range.torque_Nm, "N m")};
  Message reply = message_of(motor, "state", drive.reply_id, bus.fd, 8, false);
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

void add_damiao_registers(const BusFacts& bus, std::vector<Message>* messages) {
  Message message = message_of(all_nodes(), "register", mit::kRegisterId, bus.fd, 8, true);
  message.comment =
      "Register request to the motor with this id: its answer has the reply's identifier.";
  Signal operation = plain("operation", 16, 8, false);
  operation.words = {{mit::kReadRegister, "read"},
                     {mit::kWriteRegister, "write"},
                     {mit::kStoreRegister, "store"},
                     {mit::kStateRequest, "state request"}};
  message.signals = {plain("id", 0, 16, false), operation, plain("register", 24, 8, false),
                     plain("value", 32, 32, false)};
  messages->push_back(std::move(message));
}

}  // namespace limber::bus_tools
