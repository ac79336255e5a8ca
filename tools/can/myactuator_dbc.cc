#include "tools/can/dbc_signals.h"
#include "tools/can/mit_fields.h"
#include "tools/can/myactuator_decoder.h"

namespace limber::bus_tools {

void add_myactuator_messages(const Motor& motor, const BusFacts& /*bus*/,
                             std::vector<dbc::Message>* messages) {
  const DriveConfig& drive = motor.joint.drive;
  dbc::Message command = message_of(motor, "command", drive.command_id, false, 8, true);
  command.comment = "Motion command. Orders are under 140h + number, answered under 240h + number.";
  command.signals = mit_command_signals(drive.range);
  dbc::Message state = message_of(motor, "state", drive.reply_id, false, 8, false);
  state.comment = "State before the command took effect.";
  state.signals = mit_state_signals(drive.range);
  state.signals.insert(state.signals.begin(), plain("id", dbc::motorola_bit(0, 7), 8, true));
  messages->push_back(std::move(command));
  messages->push_back(std::move(state));
}

}  // namespace limber::bus_tools
