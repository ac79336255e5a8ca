// limber-motors: finds the motors on a bus, shows, keeps and restores what is stored in them.
// Only while nobody else sends on the bus; no command here makes a torque.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "common/config_error.h"
#include "common/program.h"
#include "tools/motors/dump.h"
#include "tools/motors/watch.h"

using namespace limber;
using namespace limber::motor_tools;

namespace {

struct Arguments {
  int (*run)(const Arguments&) = nullptr;  ///< the command that was given
  BusChoice bus;
  std::vector<std::string> buses;
  std::string file;
  std::string motor;
  std::vector<std::string> motors;
  std::int64_t wanted = 0;
  bool yaml = false;
};

/// An entry of a YAML list: what it has stored of robot.yaml's keys.
void print_for_robot(const Motor& motor, Wire* wire, bool fd) {
  std::string keys;
  for (const Setting& one : settings_of(motor, wire, fd))
    if (!one.robot_key.empty() && !one.value.empty())
      keys += fmt::format("{}: {}, ", one.robot_key, one.value);
  fmt::print("- {{family: {}, number: {}, keys: {{{}}}}}\n", motor.tool->protocol(), motor.number,
             keys);
}

int list(const Arguments& given) {
  Wire wire = open(given.bus);
  std::vector<Motor> motors;
  scan(&wire, given.bus.fd, [&](const Motor& motor, const Found& found) {
    motors.push_back(motor);
    if (!given.yaml) fmt::print("{}  {}\n", motor.word(), found.details);
  });
  if (given.yaml)
    for (const Motor& motor : motors) print_for_robot(motor, &wire, given.bus.fd);
  if (!given.bus.fd) spdlog::info("moteus motors are found with --fd");
  if (!motors.empty()) return kExitDone;
  spdlog::error(
      "{}: no motor answers: are they supplied, is the bit rate theirs, is the bus terminated at "
      "both ends?",
      given.bus.address);
  return kExitFailed;
}

/// The bus, once the motor has answered on it.
Wire open_to(const Motor& motor, const BusChoice& bus) {
  Wire wire = open(bus, motor.tool);
  require_answer(motor, &wire, bus.fd);
  return wire;
}

int show(const Arguments& given) {
  const Motor motor = motor_of(given.motor);
  Wire wire = open_to(motor, given.bus);
  for (const Setting& one : settings_of(motor, &wire, given.bus.fd))
    fmt::print("{:40} {}\n", one.name, one.value.empty() ? "not in its firmware" : one.value);
  for (const std::string& line : measured_table({motor}, &wire, given.bus.fd))
    fmt::print("{}\n", line);
  return kExitDone;
}

int set_number(const Arguments& given) {
  const Motor motor = motor_of(given.motor);
  const auto wanted = static_cast<int>(given.wanted);
  const Motor next = motor_of(fmt::format("{}:{}", motor.tool->protocol(), wanted));
  Wire wire = open_to(motor, given.bus);
  require_off(motor, &wire, given.bus.fd);
  if (answers(next, &wire, given.bus.fd))
    throw std::runtime_error(fmt::format("a motor answers to {} already", wanted));
  motor.tool->set_number(&wire, motor.number, wanted, given.bus.fd);
  std::printf("%s is %d now, stored and read back\n", motor.word().c_str(), wanted);
  return kExitDone;
}

int set_zero(const Arguments& given) {
  const Motor motor = motor_of(given.motor);
  Wire wire = open_to(motor, given.bus);
  require_off(motor, &wire, given.bus.fd);
  motor.tool->set_zero(&wire, motor.number, given.bus.fd);
  std::printf("%s: zero is where it is now, stored and read back\n", given.motor.c_str());
  return kExitDone;
}

int set_bit_rate(const Arguments& given) {
  const Motor motor = motor_of(given.motor);
  BitRate wanted{};
  std::string words;
  for (const BitRate& rate : motor.tool->bit_rates()) {
    if (rate.bps == given.wanted) wanted = rate;
    words += (words.empty() ? "" : ", ") + std::to_string(rate.bps);
  }
  if (wanted.bps == 0 && !words.empty())
    throw ConfigError(fmt::format("{} motors have {}", motor.tool->protocol(), words));
  Wire wire = open_to(motor, given.bus);
  require_off(motor, &wire, given.bus.fd);
  const std::string done = motor.tool->set_bit_rate(&wire, motor.number, wanted, given.bus.fd);
  std::printf(
      "%s: %s\nIt is silent at any other rate: set all motors of the bus, "
      "then the interface (ip link) and robot.yaml.\n",
      given.motor.c_str(), done.c_str());
  return kExitDone;
}

int dump_all(const Arguments& given) {
  std::vector<BusChoice> buses;
  for (const std::string& address : given.buses) buses.push_back({address, given.bus.fd});
  const std::string text = dump(buses);
  if (given.file.empty()) {
    std::fputs(text.c_str(), stdout);
  } else if (!(std::ofstream(given.file) << text << std::flush)) {
    throw ConfigError(given.file + ": cannot be written");
  }
  return kExitDone;
}

int restore_all(const Arguments& given) {
  restore(given.file);
  return kExitDone;
}

int watch_all(const Arguments& given) {
  std::vector<Motor> motors;
  for (const std::string& word : given.motors) motors.push_back(motor_of(word));
  watch(given.bus, std::move(motors), stop_on_signals());
  return kExitDone;
}

CommandLine& add(CommandLine& program, const char* name, const char* purpose,
                 int (*run)(const Arguments&), Arguments* given) {
  auto& command = program.command(name, purpose);
  command.when_chosen([given, run] { given->run = run; });
  return command;
}

void define(CommandLine& program, Arguments* given) {
  constexpr const char* kBus = "socketcan:can0 or virtual:NAME";
  auto& listed = add(program, "scan", "the motors of every family that answer", list, given);
  auto& shown = add(program, "show", "what a motor has stored and measures", show, given);
  auto& numbered = add(program, "set-id", "another number, stored", set_number, given);
  auto& zeroed = add(program, "zero", "where it is becomes its zero, stored", set_zero, given);
  auto& rated = add(program, "set-baud", "another bit rate", set_bit_rate, given);
  auto& dumped = add(program, "dump", "the settings of all motors as YAML", dump_all, given);
  auto& restored = add(program, "restore", "a dump's settings back", restore_all, given);
  auto& watched = add(program, "watch", "what motors measure that are off", watch_all, given);
  for (auto* command : {&listed, &shown, &numbered, &zeroed, &rated, &watched})
    command->text("bus", &given->bus.address, kBus).required();
  for (auto* command : {&shown, &numbered, &zeroed, &rated})
    command->text("motor", &given->motor, "FAMILY:NUMBER, such as damiao_mit:3").required();
  watched.texts("motor", &given->motors, "FAMILY:NUMBER; none: all that answer");
  dumped.texts("bus", &given->buses, kBus).required();
  for (auto* command : {&listed, &shown, &numbered, &zeroed, &rated, &watched, &dumped})
    command->flag("--fd", &given->bus.fd, "a CAN-FD bus");
  dumped.text("--out", &given->file, "a file for it");
  listed.flag("--yaml", &given->yaml, "with what robot.yaml needs of each");
  numbered.integer("new", &given->wanted, 1, 127, "the new number").required();
  rated.integer("rate", &given->wanted, 1, 10'000'000, "bit/s; of the data on CAN-FD").required();
  restored.text("file", &given->file, "as dump wrote it").required();
}

}  // namespace

LIMBER_MAIN(motors) {
  CommandLine line("limber-motors", "The motors on a bus, before they are an arm.");
  Arguments given;
  define(line, &given);
  return run_program(line, argc, argv, [&] { return given.run(given); });
}
