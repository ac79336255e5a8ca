// limber-driver: owns the arm's buses and is its clock.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "common/config_error.h"
#include "drivers/driver_process.h"

namespace {

volatile std::sig_atomic_t stop_asked = 0;

void ask_stop(int) { stop_asked = 1; }

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = ask_stop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

std::map<std::string, std::string> parse_buses(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> buses;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw limber::ConfigError("--bus " + text + ": write NAME=ADDRESS, as in can0=virtual:arm");
    buses[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return buses;
}

/// CLI11's own ranges let NaN pass.
CLI::Validator number_from(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        double value = 0.0;
        const bool number = CLI::detail::lexical_cast(text, value);
        if (number && value >= low && value <= high) return std::string();
        return fmt::format("{} is not a number from {:g} to {:g}", text, low, high);
      },
      "");
}

void add_options(CLI::App& app, limber::DriverProcessOptions& options,
                 std::vector<std::string>& buses) {
  app.add_option("--robot", options.robot, "shipped robot or folder with robot.yaml")
      ->capture_default_str();
  app.add_option("--bus", buses,
                 "NAME=ADDRESS: use socketcan:IFACE or virtual:GROUP for a bus of robot.yaml");
  app.add_option("--rate", options.rate_hz, "cycles per second instead of robot.yaml's")
      ->check(number_from(1.0, 20000.0));
  app.add_flag("--lockstep", options.lockstep, "no clock: simulator and controller set the pace");
  app.add_option("--session", options.session, "number of this run (default: random; lock step: 1)")
      ->check(CLI::Range(std::int64_t{1}, INT64_MAX));
  app.add_option("--duration", options.duration_s, "stop after so much arm time, s")
      ->check(number_from(1e-3, 1e8));
  app.add_option("--cycles", options.cycles, "stop after so many cycles")
      ->check(CLI::Range(std::int64_t{1}, INT64_MAX));
  app.add_option("--realtime-priority", options.realtime_priority,
                 "SCHED_FIFO priority to ask for; 0: do not ask")
      ->capture_default_str()
      ->check(CLI::Range(0, 99));
  app.add_option("--patience", options.patience_s,
                 "give up (exit 3) when motors, simulator or controller are silent so long, s")
      ->capture_default_str()
      ->check(number_from(0.0, 1e6));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Drives the motors of an arm: one frame to each and one reply from each a cycle, JOINT_STATE "
      "out, JOINT_TORQUE in.\nExit status: 0 done, 2 set-up wrong, 3 motors, simulator or "
      "controller silent."};
  limber::DriverProcessOptions options;
  std::vector<std::string> buses;
  add_options(app, options, buses);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_pattern("%T.%e limber-driver: %v");
  try {
    options.buses = parse_buses(buses);
    catch_signals();
    return limber::DriverProcess(options).run(stop_asked);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "limber-driver: %s\n", error.what());
    return 2;
  }
}
