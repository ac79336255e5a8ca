#include "tools/can/canopen_decoder.h"
#include "tools/can/dbc_signals.h"

namespace limber::bus_tools {
namespace {

using dbc::Message;
using dbc::Signal;

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

}  // namespace

void add_canopen_messages(const Motor& motor, const BusFacts& bus, std::vector<Message>* messages) {
  const CanopenDrive drive(motor, bus.fd, bus.period_s);
  for (const Pdo& pdo : drive.pdos.used())
    messages->push_back(pdo_message(motor, pdo, drive.scale, bus.fd));
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

void add_canopen_network_messages(const BusFacts& /*bus*/, std::vector<Message>* messages) {
  Message message = message_of(all_nodes(), "NMT", canopen::kNmtId, false, 2, true);
  Signal command = plain("command", 0, 8, false);
  command.words = {{1, "start"},
                   {2, "stop"},
                   {0x80, "enter pre-operational"},
                   {0x81, "reset node"},
                   {0x82, "reset communication"}};
  message.signals = {command, plain("node", 8, 8, false)};
  messages->push_back(std::move(message));
  messages->push_back(message_of(all_nodes(), "SYNC", canopen::kSyncId, false, 0, true));
}

}  // namespace limber::bus_tools
