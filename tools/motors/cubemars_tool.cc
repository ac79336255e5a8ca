// CubeMars drives with boards V1 and V2; those with boards V3 answer other frames.
#include <fmt/format.h>

#include <stdexcept>

#include "drivers/protocols/cubemars.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {
namespace {

constexpr double kCubemarsZeroing_s = 2.0;  // 1 to 1.5 s, and some more

/// As delivered; nothing tells its ranges, so that of what it measures only 0 is known.
DriveConfig delivered(int number, int board) {
  DriveConfig drive;
  drive.command_id = static_cast<std::uint32_t>(number);
  drive.board = board;
  return drive;
}
int board_of(const CanFrame& reply) { return reply.length == 6 ? cubemars::kV1 : cubemars::kV2; }

class CubemarsTool final : public MotorTool {
 public:
  std::string_view protocol() const noexcept override { return "cubemars"; }
  int last_number() const noexcept override { return cubemars::kLastMotor; }

  bool presence_switches_off() const noexcept override { return true; }
  /// Of its frames the only one that moves nothing.
  CanFrame presence(int number, bool /*fd*/) const noexcept override {
    return cubemars::off_frame(delivered(number, cubemars::kV2));
  }
  /// A Damiao drive that replies under 0 answers alike, with a temperature as last byte.
  std::optional<Found> found(const CanFrame& frame) const override {
    const int number = frame.data[0];
    cubemars::State state;
    if (number < 1 || number > cubemars::kLastMotor ||
        !cubemars::decode_state(frame, delivered(number, board_of(frame)), &state) ||
        (state.error != 0 && *cubemars::error_text(state.error, cubemars::kV2) == '\0'))
      return std::nullopt;
    return Found{number, fmt::format("board V{}", board_of(frame))};
  }

  Measured measure(Wire* wire, int number, bool /*fd*/) const override {
    const CanFrame reply = ask(wire, number);
    const cubemars::State state = state_of(reply, number);
    Measured measured{.state = "switched off"};
    if (board_of(reply) == cubemars::kV2) measured.temperature_degC = state.temperature_degC;
    if (state.error != 0)
      measured.state += std::string(", ") + cubemars::error_text(state.error, cubemars::kV2);
    return measured;
  }

  std::vector<Setting> settings(Wire* wire, int number, bool /*fd*/) const override {
    return {{.name = "board, by the length of its replies",
             .value = fmt::format("V{}", board_of(ask(wire, number))),
             .robot_key = "motors.*.board"},
            {.name = "model", .value = "not told: see its plate"},
            {.name = "ranges", .value = "not told: in the manual of model and firmware"},
            {.name = "time-out", .value = "none: it goes on with the last command"}};
  }
  std::string_view not_read() const noexcept override {
    return "MIT mode has no settings that can be read, and restore writes nothing";
  }

  /// Never: what asks switches it off.
  bool enabled(Wire* wire, int number, bool /*fd*/) const override {
    static_cast<void>(ask(wire, number));
    return false;
  }

  void set_number(Wire* /*wire*/, int /*number*/, int /*wanted*/, bool /*fd*/) const override {
    throw std::runtime_error("its maker's tool does this, over its serial port");
  }
  void set_zero(Wire* wire, int number, bool /*fd*/) const override {
    const auto id = static_cast<std::uint32_t>(number);
    wire->send(mit::encode_special(mit::Special::kSetZero, id, false), kCubemarsZeroing_s,
               [](const CanFrame&) {});
    require_zero(state_of(ask(wire, number), number).position_rad);
  }

 private:
  CanFrame ask(Wire* wire, int number) const {
    const auto reply = wire->ask(presence(number, false), comes_from(number));
    if (!reply) throw std::runtime_error("it does not answer");
    return *reply;
  }
  static cubemars::State state_of(const CanFrame& reply, int number) {
    cubemars::State state;
    static_cast<void>(cubemars::decode_state(reply, delivered(number, board_of(reply)), &state));
    return state;
  }
};

const CubemarsTool kCubemars;

}  // namespace

extern const MotorTool* const kCubemarsTool;
const MotorTool* const kCubemarsTool = &kCubemars;

}  // namespace limber::motor_tools
