#include <fmt/format.h>

#include <stdexcept>

#include "drivers/protocols/moteus.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {
namespace {

using moteus::Register;

constexpr int kMoteusLastNumber = 126;

struct MoteusShown {
  Register reg;
  const char* name;
  const char* unit;
};
constexpr MoteusShown kMoteusShown[] = {
    {Register::kModel, "model", ""},
    {Register::kFirmware, "firmware", ""},
    {Register::kRegisterMap, "register map", ""},
    {Register::kHomeState, "home state", ""},
};

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

  std::vector<Value> show(Wire* wire, int number, bool /*fd*/) const override {
    std::vector<Value> values;
    for (const MoteusShown& shown : kMoteusShown) {
      double value = 0.0;
      const auto mine = [&](const CanFrame& frame) {
        return frame.id == moteus::reply_id(static_cast<std::uint8_t>(number)) &&
               moteus::decode_register(frame, shown.reg, &value);
      };
      if (!wire->ask(moteus::encode_read(shown.reg, address(number)), mine))
        throw std::runtime_error(
            fmt::format("register {:03X}h is not answered", static_cast<std::uint16_t>(shown.reg)));
      values.push_back({shown.name, bus_tools::number(value), shown.unit});
    }
    const moteus::State state = state_of(wire, number);
    values.push_back({"position", bus_tools::number(state.position_turns), "turns"});
    values.push_back({"temperature", bus_tools::number(state.temperature_degC), "degC"});
    values.push_back({"state", moteus::mode_text(static_cast<int>(state.mode)), ""});
    values.push_back({"fault", state.fault == 0 ? "none" : moteus::fault_text(state.fault), ""});
    return values;
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
