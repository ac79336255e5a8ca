#include <algorithm>

#include "drivers/protocols/cubemars.h"
#include "tools/can/cubemars_decoder.h"
#include "tools/can/dbc_signals.h"
#include "tools/can/mit_fields.h"

namespace limber::bus_tools {

void add_cubemars_messages(const Motor& motor, const BusFacts& /*bus*/,
                           std::vector<dbc::Message>* messages) {
  const DriveConfig& drive = motor.joint.drive;
  if (drive.board == cubemars::kV3) return;
  dbc::Message command = message_of(motor, "command", drive.command_id, false, 8, true);
  command.comment = "MIT command. FF FF FF FF FF FF FF FC is enable, ..FD disable, ..FE set zero.";
  command.signals = mit_command_signals(drive.range);
  messages->push_back(std::move(command));
  if (std::ranges::find(*messages, drive.reply_id, &dbc::Message::id) != messages->end()) return;
  const int bytes = drive.board == cubemars::kV1 ? 6 : 8;
  dbc::Message state = message_of(motor, "state", drive.reply_id, false, bytes, false);
  state.comment =
      "State before the command took effect, of the motor with this id; ranges are the first's.";
  state.signals = mit_state_signals(drive.range);
  state.signals.insert(state.signals.begin(), plain("id", dbc::motorola_bit(0, 7), 8, true));
  if (bytes == 8) {
    state.signals.push_back(plain("T", dbc::motorola_bit(6, 7), 8, true, "degC"));
    state.signals.push_back(plain("error", dbc::motorola_bit(7, 7), 8, true));
  }
  messages->push_back(std::move(state));
}

}  // namespace limber::bus_tools
