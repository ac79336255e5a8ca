// limber-send: sends a request of a scenario to a running stack.
#include <cstdio>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "common/config_error.h"
#include "common/program.h"
#include "controller/laws/registry.h"
#include "tools/send/request_sender.h"
#include "tools/send/running_robot.h"

namespace {

// Not the scenario's lease: a request by hand comes from somebody else.
constexpr std::int64_t kClient = 0x48414E44;

// One answer a line, for programs that keep this one running.
int from_standard_input(limber::RequestSender& sender) {
  int result = limber::kExitDone;
  for (std::string line; std::getline(std::cin, line);) {
    if (line.empty()) continue;
    try {
      sender.send_entry(line);
      std::printf("ok\n");
    } catch (const limber::ConfigError& error) {
      std::printf("error: %s\n", error.what());
      result = limber::kExitWrongInput;
    }
    std::fflush(stdout);
  }
  return result;
}

int run(const std::string& robot, std::int64_t client, const std::vector<std::string>& entries) {
  limber::controller::load_laws();
  const limber::LoadedRobot loaded = limber::load_robot(limber::running_robot(robot));
  limber::RequestSender sender(loaded, client);
  if (entries.empty()) return from_standard_input(sender);
  for (const std::string& entry : entries) sender.send_entry(entry);
  return limber::kExitDone;
}

}  // namespace

LIMBER_MAIN(send) {
  limber::CommandLine line("limber-send",
                           "Sends a request of a scenario to a running stack: mode, gains, goal, "
                           "hand, push, wall, payload, "
                           "fault.");
  std::string robot;
  std::vector<std::string> entries;
  std::int64_t client = kClient;
  line.text("--robot", &robot, "shipped robot or folder; default: the arm of the running stack");
  line.integer("--client", &client, 1, std::numeric_limits<std::int64_t>::max(),
               "name of the lease");
  line.texts("entries", &entries,
             "such as 'gains: {law: salisbury}'; none: one a line from standard input, each "
             "answered by ok or error");
  return limber::run_program(line, argc, argv, [&] { return run(robot, client, entries); });
}
