#include "tools/can/mit_fields.h"

namespace limber::bus_tools {
namespace {

using dbc::motorola_bit;
using dbc::Signal;

constexpr int kAngleBits = 16;
constexpr int kOtherBits = 12;

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
  Signal signal{name, start, kOtherBits, true};
  signal.scale = range / 4095.0;
  signal.high = range;
  signal.unit = unit;
  return signal;
}

}  // namespace

const char* special_word(mit::Special special) {
  switch (special) {
    case mit::Special::kEnable:
      return "enable";
    case mit::Special::kDisable:
      return "disable";
    case mit::Special::kSetZero:
      return "set zero";
    case mit::Special::kClearError:
      break;
  }
  return "clear error";
}

std::vector<Value> mit_values(const mit::Command& command) {
  return {{"position", number(command.position_rad), "rad"},
          {"velocity", number(command.velocity_rad_per_s), "rad/s"},
          {"kp", number(command.kp_Nm_per_rad), "N m/rad"},
          {"kd", number(command.kd_Nms_per_rad), "N m s/rad"},
          {"torque", number(command.torque_Nm), "N m"}};
}

std::vector<Value> mit_values(const mit::Reply& reply, const CommandRange& range) {
  const double position = reply.position_rad + mit::half_count(range.position_rad, kAngleBits);
  const double velocity =
      reply.velocity_rad_per_s + mit::half_count(range.velocity_rad_per_s, kOtherBits);
  const double torque = reply.torque_Nm + mit::half_count(range.torque_Nm, kOtherBits);
  return {{"position", number(position), "rad"},
          {"velocity", number(velocity), "rad/s"},
          {"torque", number(torque), "N m"}};
}

std::vector<Signal> mit_command_signals(const CommandRange& range) {
  return {symmetric("position", motorola_bit(0, 7), kAngleBits, range.position_rad, "rad"),
          symmetric("velocity", motorola_bit(2, 7), kOtherBits, range.velocity_rad_per_s, "rad/s"),
          one_sided("kp", motorola_bit(3, 3), range.kp_Nm_per_rad, "N m/rad"),
          one_sided("kd", motorola_bit(5, 7), range.kd_Nms_per_rad, "N m s/rad"),
          symmetric("torque", motorola_bit(6, 3), kOtherBits, range.torque_Nm, "N m")};
}

std::vector<Signal> mit_state_signals(const CommandRange& range) {
  return {symmetric("position", motorola_bit(1, 7), kAngleBits, range.position_rad, "rad", true),
          symmetric("velocity", motorola_bit(3, 7), kOtherBits, range.velocity_rad_per_s, "rad/s",
                    true),
          symmetric("torque", motorola_bit(4, 3), kOtherBits, range.torque_Nm, "N m", true)};
}

}  // namespace limber::bus_tools
