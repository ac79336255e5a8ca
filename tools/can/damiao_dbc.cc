#include "tools/can/damiao_decoder.h"
#include "tools/can/dbc_signals.h"
#include "tools/can/mit_fields.h"

namespace limber::bus_tools {

using dbc::Message;
using dbc::motorola_bit;
using dbc::Signal;

void add_damiao_messages(const Motor& motor, const BusFacts& bus, std::vector<Message>* messages) {
  const DriveConfig& drive = motor.joint.drive;
  const CommandRange& range = drive.range;
  Message command = message_of(motor, "command", drive.command_id, bus.fd, 8, true);
  command.comment =
      "MIT command. FF FF FF FF FF FF FF FC is enable, ..FD disable, ..FE set zero, ..FB clear "
      "error.";
  command.signals = mit_command_signals(range);
  Message reply = message_of(motor, "state", drive.reply_id, bus.fd, 8, false);
  reply.comment =
      "State before the command took effect. Answers to register requests (7FF) have the same "
      "identifier and another layout: id, 33 or 55, register, value.";
  Signal status = plain("status", motorola_bit(0, 7), 4, true);
  for (int i = 0; i < 16; ++i) {
    const std::string word = mit::error_text(static_cast<mit::DriveError>(i));
    if (!word.empty()) status.words.emplace_back(i, word);
  }
  reply.signals = mit_state_signals(range);
  reply.signals.insert(reply.signals.begin(), {status, plain("id", motorola_bit(0, 3), 4, true)});
  reply.signals.push_back(plain("T_mos", motorola_bit(6, 7), 8, true, "degC"));
  reply.signals.push_back(plain("T_rotor", motorola_bit(7, 7), 8, true, "degC"));
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
