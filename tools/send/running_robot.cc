#include "tools/send/running_robot.h"

#include <fmt/format.h>

#include <array>
#include <limber/robot_info_t.hpp>
#include <optional>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/lcm_port.h"
#include "lcmtypes/channels.h"
#include "robots/loader/load_robot.h"

namespace limber {
namespace {

constexpr std::int64_t kPatience_ns = 2'000'000'000;

std::optional<robot_info_t> robot_info() {
  std::optional<robot_info_t> found;
  LcmPort port(user_plane_url());
  port.subscribe<robot_info_t>(channels::kRobotInfo, 1,
                               [&](const robot_info_t& info) { found = info; });
  const std::int64_t end_ns = monotonic_ns() + kPatience_ns;
  const std::array descriptors{port.descriptor()};
  while (!found && monotonic_ns() < end_ns) {
    if (wait_readable(descriptors, end_ns)) port.handle_waiting();
  }
  return found;
}

}  // namespace

std::string running_robot(const std::string& given) {
  const std::optional<robot_info_t> info = robot_info();
  if (!info) {
    if (!given.empty()) return given;  // a simulator may run alone
    throw ConfigError(
        "no controller answers: start one (limber run, limber demo); a simulated arm alone "
        "takes pushes with --robot");
  }
  if (!given.empty()) {
    const std::string name = load_robot(given).robot.name;
    if (name != info->robot) {
      throw ConfigError(fmt::format(
          "--robot: the running stack drives {}, not {}; leave --robot out", info->robot, name));
    }
  }
  return info->folder.empty() ? info->robot : info->folder;
}

}  // namespace limber
