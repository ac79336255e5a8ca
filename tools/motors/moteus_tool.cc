#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "drivers/protocols/moteus.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {
namespace {

using moteus::Register;

constexpr int kMoteusLastNumber = 126;

constexpr int kMostPolls = 10'000;  // of some sixty bytes: more than any firmware has to tell
constexpr int kMostEmptyPolls = 50;

std::uint32_t address(int number) { return moteus::command_id(static_cast<std::uint8_t>(number)); }

class MoteusTool final : public MotorTool {
 public:
  std::string_view protocol() const noexcept override { return "moteus"; }
  bool needs_fd() const noexcept override { return true; }
  int last_number() const noexcept override { return kMoteusLastNumber; }

  CanFrame presence(int number, bool /*fd*/) const noexcept override {
    return moteus::encode_state_request(address(number));
  }
  std::optional<Found> found(const CanFrame& frame) const override {
    moteus::State state;
    const int number = static_cast<int>(frame.id >> 8U);
    if (number < 1 || number > kMoteusLastNumber || (frame.id & 0xFFU) != 0 ||
        !moteus::decode_state(frame, &state))
      return std::nullopt;
    return Found{number, moteus::mode_text(static_cast<int>(state.mode))};
  }

  Measured measure(Wire* wire, int number, bool /*fd*/) const override {
    const moteus::State state = state_of(wire, number);
    return {.angle_rad = state.position_turns * moteus::kTurn_rad,
            .velocity_rad_per_s = state.velocity_turns_per_s * moteus::kTurn_rad,
            .torque_Nm = state.torque_Nm,
            .temperature_degC = state.temperature_degC,
            .supply_V = read(wire, number, Register::kVoltage),
            .state = state_text(state)};
  }

  std::vector<Setting> settings(Wire* wire, int number, bool /*fd*/) const override {
    std::vector<Setting> settings = {
        {"model", bus_tools::number(read(wire, number, Register::kModel)), Setting::Use::kModel},
        {"firmware", fmt::format("{:.0f}", read(wire, number, Register::kFirmware))}};
    std::istringstream lines(command(wire, number, "conf enumerate"));
    for (std::string name, value; lines >> name >> value;) {
      const bool writable = name.starts_with("servo.") || name.starts_with("servopos.");
      settings.push_back({name, value, writable ? Setting::Use::kWritable : Setting::Use::kOther,
                          Format::kFloatOrNone});
      if (name == "servo.pid_position.kp")
        settings.back().robot_key = "motors.*.pid_position.kp_Nm_per_turn";
      if (name == "servo.pid_position.kd")
        settings.back().robot_key = "motors.*.pid_position.kd_Nms_per_turn";
    }
    return settings;
  }
  std::string_view not_read() const noexcept override {
    return "restore writes servo and servopos: what addresses or calibrates is compared";
  }

  void write(Wire* wire, int number, const Setting& setting, double value,
             bool /*fd*/) const override {
    const std::string text = std::isnan(value) ? "nan" : fmt::format("{:.9g}", value);
    command(wire, number, fmt::format("conf set {} {}", setting.name, text));
  }
  bool store(Wire* wire, int number, bool /*fd*/) const override {
    command(wire, number, "conf write");
    return true;
  }

  bool enabled(Wire* wire, int number, bool /*fd*/) const override {
    const moteus::Mode mode = state_of(wire, number).mode;
    return mode != moteus::Mode::kStopped && mode != moteus::Mode::kFault;
  }

  void set_number(Wire* /*wire*/, int number, int wanted, bool /*fd*/) const override {
    throw std::runtime_error(
        fmt::format("its maker's tool does this: moteus_tool --target {} -c, then "
                    "'conf set id.id {}' and 'conf write'",
                    number, wanted));
  }
  void set_zero(Wire* /*wire*/, int number, bool /*fd*/) const override {
    throw std::runtime_error(
        fmt::format("its maker's tool does this: moteus_tool --target {} --zero-offset", number));
  }

 private:
  static std::string state_text(const moteus::State& state) {
    const std::string mode = moteus::mode_text(static_cast<int>(state.mode));
    return state.fault == 0 ? mode : mode + ", " + moteus::fault_text(state.fault);
  }

  static double read(Wire* wire, int number, Register reg) {
    double value = 0.0;
    const auto mine = [&](const CanFrame& frame) {
      return frame.id == moteus::reply_id(static_cast<std::uint8_t>(number)) &&
             moteus::decode_register(frame, reg, &value);
    };
    if (!wire->ask(moteus::encode_read(reg, address(number)), mine))
      throw std::runtime_error(
          fmt::format("register {:03X}h is not answered", static_cast<std::uint16_t>(reg)));
    return value;
  }

  /// What the drive answers to a line, up to its OK. Throws if it is an error, or none comes.
  static std::string command(Wire* wire, int number, const std::string& line) {
    std::string_view text;
    const auto mine = [&](const CanFrame& frame) {
      return frame.id == moteus::reply_id(static_cast<std::uint8_t>(number)) &&
             moteus::decode_text(frame, &text);
    };
    const auto ask = [&](const CanFrame& request) {
      const auto frame = wire->ask(request, mine);
      if (!frame) throw std::runtime_error("its diagnostic channel is not answered");
      static_cast<void>(moteus::decode_text(*frame, &text));  // of the frame that is kept
      return std::string(text);
    };
    const CanFrame poll = moteus::encode_text_poll(address(number));
    for (int polls = 0; polls < kMostPolls && !ask(poll).empty(); ++polls) {  // of somebody before
    }
    std::string answer = ask(moteus::encode_line(line + '\n', address(number)));
    for (int polls = 0, empty = 0; polls < kMostPolls && empty < kMostEmptyPolls; ++polls) {
      if (answer.ends_with("OK\r\n")) return answer.substr(0, answer.size() - 4);
      if (answer.starts_with("ERR") && answer.ends_with('\n'))
        throw std::runtime_error(fmt::format("it refuses '{}': {}", line,
                                             answer.substr(0, answer.find_first_of("\r\n"))));
      const std::string more = ask(poll);
      empty = more.empty() ? empty + 1 : 0;
      answer += more;
    }
    throw std::runtime_error(fmt::format("'{}' is not answered", line));
  }

  static moteus::State state_of(Wire* wire, int number) {
    moteus::State state;
    const auto mine = [&](const CanFrame& frame) {
      return frame.id == moteus::reply_id(static_cast<std::uint8_t>(number)) &&
             moteus::decode_state(frame, &state);
    };
    if (!wire->ask(moteus::encode_state_request(address(number)), mine))
      throw std::runtime_error("it does not answer");
    return state;
  }
};

const MoteusTool kMoteus;

}  // namespace

extern const MotorTool* const kMoteusTool;
const MotorTool* const kMoteusTool = &kMoteus;

}  // namespace limber::motor_tools
