// limber-ask: says to a running stack what a scenario would say.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "common/config_error.h"
#include "tools/ask/asker.h"

namespace {

// Not the scenario's lease: whoever asks by hand is somebody else.
constexpr std::int64_t kClient = 0x48414E44;

// One answer a line, for programs that keep this one running.
int from_standard_input(limber::Asker& asker) {
  int result = 0;
  for (std::string line; std::getline(std::cin, line);) {
    if (line.empty()) continue;
    try {
      asker.ask(line);
      std::printf("ok\n");
    } catch (const limber::ConfigError& error) {
      std::printf("error: %s\n", error.what());
      result = 2;
    }
    std::fflush(stdout);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Says to a running stack what a scenario would say: mode, gains, goal, push, wall, payload, "
      "fault."};
  std::string robot = "openarm";
  std::vector<std::string> entries;
  std::int64_t client = kClient;
  app.add_option("--robot", robot, "shipped robot or folder with robot.yaml")
      ->capture_default_str();
  app.add_option("--client", client, "name of the lease")->check(CLI::PositiveNumber);
  app.add_option("entries", entries,
                 "such as 'gains: {law: salisbury}'; none: one a line from standard input, each "
                 "answered by ok or error");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    const limber::LoadedRobot loaded = limber::load_robot(robot);
    limber::Asker asker(loaded, client);
    if (entries.empty()) return from_standard_input(asker);
    for (const std::string& entry : entries) asker.ask(entry);
    return 0;
  } catch (const limber::ConfigError& error) {
    std::fprintf(stderr, "limber-ask: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "limber-ask: %s\n", error.what());
    return 3;
  }
}
