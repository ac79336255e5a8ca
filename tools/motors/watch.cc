#include "tools/motors/watch.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace limber::motor_tools {
namespace {

constexpr double kTerminalPause_s = 0.2;
constexpr double kPipePause_s = 1.0;
constexpr const char* kRow = "{:16} {:>9} {:>9} {:>9} {:>6} {:>7}  {}";

std::string cell(double value, int decimals) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, decimals);
}

std::string row(const Motor& motor, Wire* wire, bool fd) {
  Measured now;
  try {
    now = motor.tool->measure(wire, motor.number, fd);
  } catch (const std::runtime_error& error) {  // a plug that is being wiggled
    now.state = fmt::format("NO ANSWER: {}", error.what());
  }
  return fmt::format(kRow, motor.word(), cell(now.angle_rad, 4), cell(now.velocity_rad_per_s, 3),
                     cell(now.torque_Nm, 3), cell(now.temperature_degC, 0), cell(now.supply_V, 1),
                     now.state);
}

}  // namespace

std::vector<std::string> measured_table(const std::vector<Motor>& motors, Wire* wire, bool fd) {
  std::vector<std::string> lines = {
      fmt::format(kRow, "motor", "angle", "velocity", "torque", "temp.", "supply", "state"),
      fmt::format(kRow, "", "rad", "rad/s", "N m", "degC", "V", "")};
  for (const Motor& motor : motors) lines.push_back(row(motor, wire, fd));
  return lines;
}

void watch(const BusChoice& bus, std::vector<Motor> motors,
           const volatile std::sig_atomic_t& stop) {
  Wire wire = open(bus, motors.empty() ? nullptr : motors.front().tool);
  if (motors.empty()) motors = motors_on(&wire, bus.fd);
  if (motors.empty()) throw std::runtime_error(bus.address + ": no motor answers");
  for (const Motor& motor : motors) {
    require_answer(motor, &wire, bus.fd);
    require_off(motor, &wire, bus.fd);
  }
  const bool terminal = isatty(STDOUT_FILENO) == 1;
  bool first = true;
  while (stop == 0) {
    const auto lines = measured_table(motors, &wire, bus.fd);
    std::string text = first ? "" : terminal ? fmt::format("\033[{}A", lines.size()) : "\n";
    first = false;
    for (const std::string& line : lines) text += line + (terminal ? "\033[K\n" : "\n");
    std::fputs(text.c_str(), stdout);
    if (std::fflush(stdout) != 0) return;  // nobody reads
    wire.require_quiet(terminal ? kTerminalPause_s : kPipePause_s);
  }
}

}  // namespace limber::motor_tools
