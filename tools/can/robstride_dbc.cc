#include "drivers/protocols/robstride.h"
#include "tools/can/dbc_signals.h"
#include "tools/can/robstride_decoder.h"

namespace limber::bus_tools {
namespace {

dbc::Signal symmetric(const char* name, int byte, double range, const char* unit) {
  dbc::Signal signal{name, dbc::motorola_bit(byte, 7), 16, true};
  signal.scale = range / 32767.0;
  signal.offset = -range;
  signal.low = -range;
  signal.high = range;
  signal.unit = unit;
  return signal;
}

}  // namespace

void add_robstride_messages(const Motor& motor, const BusFacts& /*bus*/,
                            std::vector<dbc::Message>* messages) {
  const DriveConfig& drive = motor.joint.drive;
  robstride::State running;
  running.motor = static_cast<std::uint8_t>(drive.command_id);
  running.mode = robstride::Mode::kRun;
  const CanFrame frame = encode_state(running, drive.range, robstride::Type::kState);
  dbc::Message state = message_of(motor, "state", frame.id, false, 8, false);
  state.comment =
      "State while running without a fault: mode and faults are bits 16 to 23 of the identifier. "
      "Commands have their torque in the identifier and are not listed.";
  dbc::Signal temperature = plain("T", dbc::motorola_bit(6, 7), 16, true, "degC");
  temperature.scale = 0.1;
  temperature.high = 6553.5;
  state.signals = {symmetric("position", 0, drive.range.position_rad, "rad"),
                   symmetric("velocity", 2, drive.range.velocity_rad_per_s, "rad/s"),
                   symmetric("torque", 4, drive.range.torque_Nm, "N m"), temperature};
  messages->push_back(std::move(state));
}

}  // namespace limber::bus_tools
