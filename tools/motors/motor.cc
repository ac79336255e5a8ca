#include "tools/motors/motor.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <stdexcept>

#include "common/config_error.h"

namespace limber::motor_tools {
namespace {

constexpr double kScan_s = 0.003;  // for each number

}  // namespace

std::string Motor::word() const { return fmt::format("{}:{}", tool->protocol(), number); }

Motor motor_of(const std::string& word) {
  const auto colon = word.find(':');
  if (colon == std::string::npos)
    throw ConfigError("motor '" + word + "': expected FAMILY:NUMBER, such as damiao_mit:3");
  const MotorTool& tool = tool_of(word.substr(0, colon));
  const char* const end = word.data() + word.size();
  int number = 0;
  const auto [rest, error] = std::from_chars(word.data() + colon + 1, end, number);
  if (error != std::errc() || rest != end || number < 1 || number > tool.last_number())
    throw ConfigError(
        fmt::format("motor '{}': its number is to be 1 to {}", word, tool.last_number()));
  return {&tool, number};
}

Wire open(const BusChoice& bus, const MotorTool* tool) {
  if (tool != nullptr && tool->needs_fd() && !bus.fd)
    throw ConfigError(std::string(tool->protocol()) + " motors need --fd");
  return {bus.address, bus.fd, [](const CanFrame& frame) {
            return std::ranges::any_of(
                all_tools(), [&](const MotorTool* one) { return one->sends_unasked(frame); });
          }};
}

void scan(Wire* wire, bool fd, const std::function<void(const Motor&, const Found&)>& found) {
  std::set<int> taken;
  std::vector<Motor> all;
  const auto would_obey = [&](const CanFrame& frame) {
    return !frame.extended && std::ranges::any_of(all, [&](const Motor& motor) {
      return motor.tool->obeys(motor.number, frame.id);
    });
  };
  for (const MotorTool* tool : all_tools()) {
    if (tool->needs_fd() && !fd) continue;
    for (int number = 1; number <= tool->last_number(); ++number) {
      if (tool->presence_switches_off() && taken.contains(number)) continue;
      const CanFrame presence = tool->presence(number, fd);
      if (!presence.remote && would_obey(presence)) continue;
      wire->send(presence, kScan_s, [&](const CanFrame& frame) {
        const auto motor = tool->found(frame);
        if (!motor) return;
        taken.insert(motor->number);
        all.push_back({tool, motor->number});
        found({tool, motor->number}, *motor);
      });
    }
  }
}

std::vector<Motor> motors_on(Wire* wire, bool fd) {
  std::vector<Motor> motors;
  scan(wire, fd, [&](const Motor& motor, const Found& /*found*/) {
    if (std::ranges::count(motors, motor.word(), &Motor::word) > 0)
      throw std::runtime_error(
          fmt::format("{}: two motors answer to {}: unplug one, give the other "
                      "a new number",
                      wire->address(), motor.word()));
    motors.push_back(motor);
  });
  return motors;
}

bool answers(const Motor& motor, Wire* wire, bool fd) {
  const CanFrame presence = motor.tool->presence(motor.number, fd);
  return wire->ask(presence, motor.tool->comes_from(motor.number)).has_value();
}

void require_answer(const Motor& motor, Wire* wire, bool fd) {
  if (!answers(motor, wire, fd))
    throw std::runtime_error(
        fmt::format("{} does not answer on {}; `limber motors scan {}` lists those that do",
                    motor.word(), wire->address(), wire->address()));
}

void require_off(const Motor& motor, Wire* wire, bool fd) {
  if (motor.tool->enabled(wire, motor.number, fd))
    throw std::runtime_error(motor.word() + ": its power stage is on: end what holds it first");
}

std::vector<Setting> settings_of(const Motor& motor, Wire* wire, bool fd) {
  auto settings = motor.tool->settings(wire, motor.number, fd);
  if (std::ranges::any_of(settings, [](const Setting& one) { return one.value.empty(); }))
    require_answer(motor, wire, fd);  // the setting is missing, not the motor
  return settings;
}

}  // namespace limber::motor_tools
