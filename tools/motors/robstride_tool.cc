#include <fmt/format.h>

#include <bit>
#include <stdexcept>

#include "drivers/protocols/robstride.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {
namespace {

using robstride::Parameter;
using robstride::Type;

constexpr double kRobstrideSave_s = 0.1;
constexpr double kRobstrideReport_s = 0.5;

struct RobstrideShown {
  Parameter parameter;
  const char* name;
  const char* unit;
  double scale;  ///< 0: a float32
};
constexpr RobstrideShown kRobstrideShown[] = {
    {Parameter::kRunMode, "run mode", "", 1.0},
    {Parameter::kPosition, "position", "rad", 0.0},
    {Parameter::kVelocity, "velocity", "rad/s", 0.0},
    {Parameter::kVoltage, "supply", "V", 0.0},
    {Parameter::kTimeout, "time-out (0: off)", "s", robstride::kTimeoutCount_s},
    {Parameter::kZeroAtStart, "zero at start (1: -pi to pi)", "", 1.0},
};

std::uint8_t as_number(int number) { return static_cast<std::uint8_t>(number); }

class RobstrideTool final : public MotorTool {
 public:
  std::string_view protocol() const noexcept override { return "robstride"; }
  int last_number() const noexcept override { return robstride::kLastMotor; }

  CanFrame presence(int number, bool /*fd*/) const noexcept override {
    return robstride::request(Type::kPing, as_number(number));
  }
  std::optional<Found> found(const CanFrame& frame) const override {
    robstride::Id id{};
    if (!robstride::split(frame, &id) || id.type != Type::kPing ||
        id.target != robstride::kEverybody || id.data > robstride::kLastMotor)
      return std::nullopt;
    return Found{id.data, "unique id " + bus_tools::bytes(frame)};
  }

  /// Reports and faults.
  bool sends_unasked(const CanFrame& frame) const noexcept override {
    robstride::Id id{};
    return robstride::split(frame, &id) && id.target > robstride::kLastMotor &&
           (id.type == Type::kReport || id.type == Type::kFault);
  }

  std::vector<Value> show(Wire* wire, int number, bool /*fd*/) const override {
    std::vector<Value> values;
    for (const RobstrideShown& shown : kRobstrideShown) {
      const robstride::ParameterAnswer answer = read(wire, number, shown.parameter);
      const double value = shown.scale > 0.0
                               ? answer.raw * shown.scale
                               : static_cast<double>(std::bit_cast<float>(answer.raw));
      values.push_back({shown.name,
                        answer.refused ? "not in this firmware" : bus_tools::number(value),
                        answer.refused ? "" : shown.unit});
    }
    const robstride::State state = report(wire, number);
    const std::string faults = robstride::faults_text(state.faults);
    values.push_back({"temperature", bus_tools::number(state.temperature_degC), "degC"});
    values.push_back({"state", state.mode == robstride::Mode::kRun ? "running" : "stopped", ""});
    values.push_back({"faults", faults.empty() ? "none" : faults, ""});
    return values;
  }

  bool enabled(Wire* wire, int number, bool /*fd*/) const override {
    return report(wire, number).mode == robstride::Mode::kRun;
  }

  void set_number(Wire* wire, int number, int wanted, bool fd) const override {
    wire->send(robstride::encode_set_id(as_number(number), as_number(wanted)), kRobstrideSave_s,
               [](const CanFrame&) {});
    save(wire, wanted);
    require_number(wire, wanted, fd);
  }

  void set_zero(Wire* wire, int number, bool /*fd*/) const override {
    wire->send(robstride::encode_set_zero(as_number(number)), kRobstrideSave_s,
               [](const CanFrame&) {});
    save(wire, number);
    const robstride::ParameterAnswer answer = read(wire, number, Parameter::kPosition);
    if (answer.refused) throw std::runtime_error("its angle cannot be read back");
    require_zero(std::bit_cast<float>(answer.raw));
  }

 private:
  static robstride::ParameterAnswer read(Wire* wire, int number, Parameter parameter) {
    const auto index = static_cast<std::uint16_t>(parameter);
    robstride::ParameterAnswer answer;
    const auto mine = [&](const CanFrame& frame) {
      return robstride::decode_parameter_answer(frame, &answer) &&
             answer.motor == as_number(number) && answer.index == index;
    };
    if (!wire->ask(robstride::encode_read(as_number(number), index), mine))
      throw std::runtime_error(fmt::format("parameter {:04X} is not answered", index));
    return answer;
  }

  static void save(Wire* wire, int number) {
    wire->send(robstride::encode_save(as_number(number)), kRobstrideSave_s, [](const CanFrame&) {});
  }

  /// A state without a command: reports are switched on until one comes. Its fields are shares of
  /// ranges that are not known here.
  static robstride::State report(Wire* wire, int number) {
    robstride::State state;
    const auto mine = [&](const CanFrame& answer) {
      robstride::Id id{};
      return robstride::split(answer, &id) && id.type == Type::kReport &&
             robstride::decode_state(answer, {}, &state) && state.motor == as_number(number);
    };
    wire->send(robstride::encode_report(as_number(number), true), 0.0, [](const CanFrame&) {});
    const bool came = wire->await(mine, kRobstrideReport_s).has_value();
    wire->send(robstride::encode_report(as_number(number), false), Wire::kAnswer_s,
               [](const CanFrame&) {});
    if (!came) throw std::runtime_error("it does not report its state");
    return state;
  }
};

const RobstrideTool kRobstride;

}  // namespace

extern const MotorTool* const kRobstrideTool;
const MotorTool* const kRobstrideTool = &kRobstride;

}  // namespace limber::motor_tools
