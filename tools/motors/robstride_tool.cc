#include <fmt/format.h>

#include <stdexcept>

#include "drivers/protocols/robstride.h"
#include "tools/motors/registers.h"

namespace limber::motor_tools {
namespace {

using robstride::Parameter;
using robstride::Type;

constexpr double kRobstrideSave_s = 0.1;
constexpr double kRobstrideReport_s = 0.5;

constexpr BitRate kRobstrideBitRates[] = {{1'000'000, 1}, {500'000, 2}, {250'000, 3}, {125'000, 4}};

std::uint8_t as_number(int number) { return static_cast<std::uint8_t>(number); }

class RobstrideTool final : public RegisterTool {
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

  /// No torque: it is a share of a range that only the plate of the drive tells.
  Measured measure(Wire* wire, int number, bool /*fd*/) const override {
    const auto value = [&](Parameter parameter) {
      return read_float(wire, number, static_cast<std::uint32_t>(parameter), false);
    };
    const robstride::State state = report(wire, number);
    return {.angle_rad = value(Parameter::kPosition),
            .velocity_rad_per_s = value(Parameter::kVelocity),
            .temperature_degC = state.temperature_degC,
            .supply_V = value(Parameter::kVoltage),
            .state = state_text(state)};
  }

  std::vector<Setting> settings(Wire* wire, int number, bool fd) const override {
    const auto presented = wire->ask(presence(number, fd), comes_from(number));
    if (!presented) throw std::runtime_error("it does not answer");
    std::vector<Setting> settings = RegisterTool::settings(wire, number, fd);
    settings.push_back({"unique id", bus_tools::bytes(*presented), Setting::Use::kModel});
    return settings;
  }
  std::string_view not_read() const noexcept override {
    return "its protocol tells neither model nor firmware: the unique id stands for them";
  }

  bool store(Wire* wire, int number, bool /*fd*/) const override {
    save(wire, number);
    return true;
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
    require_zero(read_float(wire, number, static_cast<std::uint32_t>(Parameter::kPosition), false));
  }

  std::span<const BitRate> bit_rates() const noexcept override { return kRobstrideBitRates; }
  std::string set_bit_rate(Wire* wire, int number, const BitRate& rate,
                           bool /*fd*/) const override {
    if (!wire->ask(robstride::encode_set_baud(as_number(number), rate.code), comes_from(number)))
      throw std::runtime_error("its new bit rate is not answered");
    return "answered; it counts when its supply was off, and its protocol cannot read it back";
  }

 private:
  static std::string state_text(const robstride::State& state) {
    const std::string faults = robstride::faults_text(state.faults);
    return (state.mode == robstride::Mode::kRun ? "running" : "stopped") +
           (faults.empty() ? "" : ", " + faults);
  }

  const std::vector<StoredRegister>& stored() const override {
    using enum Setting::Use;
    static const std::vector<StoredRegister> kStored = {
        {0x700B, "limit_torque (N m)", Format::kFloat, kWritable},
        {0x7017, "limit_spd (rad/s)", Format::kFloat, kWritable},
        {0x7018, "limit_cur (A)", Format::kFloat, kWritable},
        {0x7026, "report period (1: 10 ms, 5 ms a count)", Format::kUint16, kWritable},
        {0x7028, "CAN time-out (counts of 50 us, 0: off)", Format::kUint32, kWritable},
        {0x7029, "zero at start (1: -pi to pi)", Format::kUint8, kOther},
        {0x702A, "damper (1: none when off)", Format::kUint8, kWritable},
        {0x702B, "add_offset (rad)", Format::kFloat, kOther},
    };
    return kStored;
  }

  std::optional<std::uint32_t> try_read(Wire* wire, int number, std::uint32_t parameter,
                                        bool /*fd*/) const override {
    const auto index = static_cast<std::uint16_t>(parameter);
    robstride::ParameterAnswer answer;
    const auto mine = [&](const CanFrame& frame) {
      return robstride::decode_parameter_answer(frame, &answer) &&
             answer.motor == as_number(number) && answer.index == index;
    };
    if (!wire->ask(robstride::encode_read(as_number(number), index), mine))
      throw std::runtime_error(fmt::format("parameter {:04X} is not answered", index));
    return answer.refused ? std::nullopt : std::optional(answer.raw);
  }

  void put(Wire* wire, int number, const StoredRegister& reg, std::uint32_t raw,
           bool /*fd*/) const override {
    const auto index = static_cast<std::uint16_t>(reg.number);
    const auto taken = [&](const CanFrame& frame) { return is_state(frame, number, Type::kState); };
    if (!wire->ask(robstride::encode_write(as_number(number), index, raw), taken))
      throw std::runtime_error(fmt::format("writing {} is not answered", reg.name));
  }

  /// Its fields are shares of ranges that are not known here.
  static bool is_state(const CanFrame& frame, int number, Type type,
                       robstride::State* state = nullptr) {
    robstride::State read;
    robstride::Id id{};
    const bool is = robstride::split(frame, &id) && id.type == type &&
                    robstride::decode_state(frame, {}, &read) && read.motor == as_number(number);
    if (is && state != nullptr) *state = read;
    return is;
  }

  static void save(Wire* wire, int number) {
    wire->send(robstride::encode_save(as_number(number)), kRobstrideSave_s, [](const CanFrame&) {});
  }

  /// A state without a command: reports are switched on until one comes.
  static robstride::State report(Wire* wire, int number) {
    robstride::State state;
    const auto reported = [&](const CanFrame& frame) {
      return is_state(frame, number, Type::kReport, &state);
    };
    const auto ended = [&](const CanFrame& frame) { return is_state(frame, number, Type::kState); };
    wire->send(robstride::encode_report(as_number(number), true), 0.0, [](const CanFrame&) {});
    const bool came = wire->await(reported, kRobstrideReport_s).has_value();
    wire->send(robstride::encode_report(as_number(number), false), 0.0, [](const CanFrame&) {});
    static_cast<void>(wire->await(ended, Wire::kAnswer_s));
    if (!came) throw std::runtime_error("it does not report its state");
    return state;
  }
};

const RobstrideTool kRobstride;

}  // namespace

extern const MotorTool* const kRobstrideTool;
const MotorTool* const kRobstrideTool = &kRobstride;

}  // namespace limber::motor_tools
