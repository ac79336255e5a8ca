#include "tools/check/gains_report.h"

#include <fmt/format.h>

#include <variant>

#include "controller/arm_controller.h"

namespace limber {

std::vector<std::string> refused_gains(const Scenario& scenario, const LoadedRobot& robot) {
  std::vector<std::string> warnings;
  if (!robot.robot.has_drives) return warnings;
  ArmController controller(robot, ArmControllerOptions{});
  for (const TimedMessage& timed : scenario.timeline) {
    const auto* gains = std::get_if<compliance_gains_t>(&timed.message);
    if (gains == nullptr) continue;
    if (const char* reason = controller.on_gains(*gains)) {
      warnings.push_back(fmt::format("gains at {:g} s will be refused: {}",
                                     static_cast<double>(timed.time_ns) * 1e-9, reason));
    }
  }
  return warnings;
}

}  // namespace limber
