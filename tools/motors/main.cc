// limber-motors: finds the motors on a bus, shows what is stored in them, sets number and zero.
// Only while nobody else sends on the bus; no command here makes a torque.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <stdexcept>

#include "common/config_error.h"
#include "common/program.h"
#include "tools/motors/motor_tool.h"

using namespace limber;
using namespace limber::motor_tools;

namespace {

constexpr double kScan_s = 0.003;  // for each number

struct Arguments {
  int (*run)(const Arguments&) = nullptr;  ///< the command that was given
  std::string bus;
  std::string motor;
  bool fd = false;
  std::int64_t wanted = 0;
};

struct Motor {
  const MotorTool* tool;
  int number;
};

/// "damiao_mit:3"
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

Wire open(const Arguments& given, const MotorTool* tool = nullptr) {
  if (tool != nullptr && tool->needs_fd() && !given.fd)
    throw ConfigError(std::string(tool->protocol()) + " motors need --fd");
  return {given.bus, given.fd, [](const CanFrame& frame) {
            return std::ranges::any_of(
                all_tools(), [&](const MotorTool* one) { return one->sends_unasked(frame); });
          }};
}

int scan(const Arguments& given) {
  Wire wire = open(given);
  int motors = 0;
  for (const MotorTool* tool : all_tools()) {
    if (tool->needs_fd() && !given.fd) continue;
    for (int number = 1; number <= tool->last_number(); ++number) {
      wire.send(tool->presence(number, given.fd), kScan_s, [&](const CanFrame& frame) {
        const std::optional<Found> found = tool->found(frame);
        if (!found) return;
        ++motors;
        std::printf("%s:%d  %s\n", std::string(tool->protocol()).c_str(), found->number,
                    found->details.c_str());
      });
    }
  }
  if (!given.fd) spdlog::info("moteus motors are found with --fd");
  if (motors > 0) return kExitDone;
  spdlog::error(
      "{}: no motor answers: are they supplied, is the bit rate theirs, is the bus terminated at "
      "both ends?",
      given.bus);
  return kExitFailed;
}

bool answers(const Motor& motor, Wire* wire, bool fd) {
  return wire
      ->ask(motor.tool->presence(motor.number, fd),
            [&](const CanFrame& frame) {
              const auto found = motor.tool->found(frame);
              return found && found->number == motor.number;
            })
      .has_value();
}

/// The bus, once the motor has answered on it.
Wire open_to(const Motor& motor, const Arguments& given) {
  Wire wire = open(given, motor.tool);
  if (!answers(motor, &wire, given.fd))
    throw std::runtime_error(
        fmt::format("{} does not answer on {}; `limber motors scan {}` lists "
                    "those that do",
                    given.motor, given.bus, given.bus));
  return wire;
}

int show(const Arguments& given) {
  const Motor motor = motor_of(given.motor);
  Wire wire = open_to(motor, given);
  for (const bus_tools::Value& value : motor.tool->show(&wire, motor.number, given.fd))
    std::printf("%-28s %s%s%s\n", value.name.c_str(), value.text.c_str(),
                value.unit.empty() ? "" : " ", value.unit.c_str());
  return kExitDone;
}

void refuse_if_enabled(const Motor& motor, Wire* wire, const Arguments& given) {
  if (motor.tool->enabled(wire, motor.number, given.fd))
    throw std::runtime_error(given.motor + ": its power stage is on: end what holds it first");
}

int set_number(const Arguments& given) {
  const Motor motor = motor_of(given.motor);
  const auto wanted = static_cast<int>(given.wanted);
  const Motor next = motor_of(fmt::format("{}:{}", motor.tool->protocol(), wanted));
  Wire wire = open_to(motor, given);
  refuse_if_enabled(motor, &wire, given);
  if (answers(next, &wire, given.fd))
    throw std::runtime_error(fmt::format("a motor answers to {} already", wanted));
  motor.tool->set_number(&wire, motor.number, wanted, given.fd);
  std::printf("%s:%d is %d now, stored and read back\n",
              std::string(motor.tool->protocol()).c_str(), motor.number, wanted);
  return kExitDone;
}

int set_zero(const Arguments& given) {
  const Motor motor = motor_of(given.motor);
  Wire wire = open_to(motor, given);
  refuse_if_enabled(motor, &wire, given);
  motor.tool->set_zero(&wire, motor.number, given.fd);
  std::printf("%s: zero is where it is now, stored and read back\n", given.motor.c_str());
  return kExitDone;
}

CommandLine& add(CommandLine& program, const char* name, const char* purpose,
                 int (*run)(const Arguments&), Arguments* given) {
  auto& command = program.command(name, purpose);
  command.when_chosen([given, run] { given->run = run; });
  command.text("bus", &given->bus, "socketcan:can0 or virtual:NAME").required();
  command.flag("--fd", &given->fd, "a CAN-FD bus");
  return command;
}

void define(CommandLine& program, Arguments* given) {
  add(program, "scan", "the motors of every family that answer", scan, given);
  auto& shown = add(program, "show", "what a motor has stored and measures", show, given);
  auto& numbered = add(program, "set-id", "another number, stored", set_number, given);
  auto& zeroed = add(program, "zero", "where it is becomes its zero, stored", set_zero, given);
  for (auto* command : {&shown, &numbered, &zeroed})
    command->text("motor", &given->motor, "FAMILY:NUMBER, such as damiao_mit:3").required();
  numbered.integer("new", &given->wanted, 1, 127, "the new number").required();
}

}  // namespace

LIMBER_MAIN(motors) {
  CommandLine line("limber-motors", "The motors on a bus, before they are an arm.");
  Arguments given;
  define(line, &given);
  return run_program(line, argc, argv, [&] { return given.run(given); });
}
