#include <fmt/format.h>

#include <stdexcept>

#include "drivers/protocols/myactuator.h"
#include "robots/loader/protocols/myactuator_series.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {
namespace {

using myactuator::Order;

constexpr BitRate kMyactuatorBitRates[] = {{500'000, 0}, {1'000'000, 1}};
constexpr double kMyactuatorReset_s = 2.0;  // 1.1 s, and some more

std::string version_text(std::uint32_t version) {
  if (version == 0) return "its time-out is over";  // the request itself, sent back
  return fmt::format("firmware {} ({})", version,
                     myactuator::name_of(myactuator::firmware_of(version)));
}

class MyactuatorTool final : public MotorTool {
 public:
  std::string_view protocol() const noexcept override { return "myactuator"; }
  int last_number() const noexcept override { return myactuator::kLastMotor; }

  CanFrame presence(int number, bool /*fd*/) const noexcept override {
    return myactuator::order_frame(Order::kVersion, number);
  }
  std::optional<Found> found(const CanFrame& frame) const override {
    const int number = static_cast<int>(frame.id) - static_cast<int>(myactuator::kAnswerId);
    if (number < 1 || number > myactuator::kLastMotor ||
        !myactuator::answers(frame, Order::kVersion, number))
      return std::nullopt;
    return Found{number, version_text(myactuator::value_of(frame))};
  }
  /// Time-outs and errors.
  bool sends_unasked(const CanFrame& frame) const noexcept override {
    const int number = static_cast<int>(frame.id) - static_cast<int>(myactuator::kAnswerId);
    return number >= 1 && number <= myactuator::kLastMotor &&
           (myactuator::answers(frame, Order::kTimedOut, number) ||
            myactuator::answers(frame, Order::kStatus, number));
  }

  Measured measure(Wire* wire, int number, bool /*fd*/) const override {
    const double angle = myactuator::decode_angle(read(wire, number, Order::kAngle));
    const auto status = myactuator::decode_status(read(wire, number, Order::kStatus));
    return {.angle_rad = angle,
            .temperature_degC = static_cast<double>(status.temperature_degC),
            .supply_V = status.supply_V,
            .state = state_text(status)};
  }

  std::vector<Setting> settings(Wire* wire, int number, bool /*fd*/) const override {
    myactuator::ModelText model;
    for (const int block : {1, 2})
      model.add(ask(wire, number, myactuator::model_frame(number, block)));
    const auto version = myactuator::value_of(read(wire, number, Order::kVersion));
    const auto firmware = myactuator::firmware_of(version);
    const auto add = [](const char* name, const std::string& value, const char* key) {
      return Setting{name, value, Setting::Use::kOther, Format::kText, key};
    };
    std::vector<Setting> settings = {
        {"model", std::string(model.text()), Setting::Use::kModel},
        {"firmware", std::to_string(version)},
        add("ranges of its firmware", myactuator::name_of(firmware), "motors.*.firmware")};
    if (is_listed(model.series()))
      settings.push_back(add("series", fmt::format("X{}", model.series()), "motors.*.model"));
    if (firmware == myactuator::Firmware::kV42)
      settings.push_back(add("torque of a command, at most (N m)", "24", "most.torque_Nm"));
    return settings;
  }
  std::string_view not_read() const noexcept override {
    return "motion mode has no settings that can be read: time-out, zero and gains of the other "
           "modes are not here, and restore writes nothing";
  }

  /// Whether its brake is released: nothing tells more.
  bool enabled(Wire* wire, int number, bool /*fd*/) const override {
    return myactuator::decode_status(read(wire, number, Order::kStatus)).brake_released;
  }

  void set_number(Wire* wire, int number, int wanted, bool fd) const override {
    static_cast<void>(ask(wire, number,
                          myactuator::function_frame(myactuator::Function::kSetNumber, number,
                                                     static_cast<std::uint32_t>(wanted))));
    reset(wire, number);
    require_number(wire, wanted, fd);
  }

  void set_zero(Wire* wire, int number, bool /*fd*/) const override {
    static_cast<void>(read(wire, number, Order::kSetZero));
    reset(wire, number);
    require_zero(myactuator::decode_angle(read(wire, number, Order::kAngle)));
  }

  std::span<const BitRate> bit_rates() const noexcept override { return kMyactuatorBitRates; }
  /// Without a usable answer: the drive may send it at either rate.
  std::string set_bit_rate(Wire* wire, int number, const BitRate& rate, bool fd) const override {
    static_cast<void>(read(wire, number, Order::kVersion));  // the next one is not only sent back
    wire->send(myactuator::bit_rate_frame(number, rate.code), Wire::kAnswer_s,
               [](const CanFrame&) {});
    return wire->ask(presence(number, fd), comes_from(number))
               ? "it answers here still: if this is not the rate that you gave, it counts when its "
                 "supply was off. It cannot be read back"
               : "it no longer answers here, as it should: it has its new rate";
  }

 private:
  static std::string state_text(const myactuator::Status& status) {
    const std::string errors = myactuator::errors_text(status.errors);
    return std::string(status.brake_released ? "brake released" : "brake locked") +
           (errors.empty() ? "" : ", " + errors);
  }
  static CanFrame ask(Wire* wire, int number, const CanFrame& request) {
    const auto order = static_cast<Order>(request.data[0]);
    const auto mine = [&](const CanFrame& frame) {
      return myactuator::answers(frame, order, number);
    };
    // The first frame after a time-out is only sent back.
    static_cast<void>(wire->ask(myactuator::order_frame(Order::kVersion, number), [&](auto& frame) {
      return myactuator::answers(frame, Order::kVersion, number);
    }));
    const auto answer = wire->ask(request, mine);
    if (!answer)
      throw std::runtime_error(fmt::format("order {:02X} is not answered", request.data[0]));
    return *answer;
  }
  static CanFrame read(Wire* wire, int number, Order order) {
    return ask(wire, number, myactuator::order_frame(order, number));
  }
  static void reset(Wire* wire, int number) {
    wire->send(myactuator::order_frame(Order::kReset, number), kMyactuatorReset_s,
               [](const CanFrame&) {});
  }
};

const MyactuatorTool kMyactuator;

}  // namespace

extern const MotorTool* const kMyactuatorTool;
const MotorTool* const kMyactuatorTool = &kMyactuator;

}  // namespace limber::motor_tools
