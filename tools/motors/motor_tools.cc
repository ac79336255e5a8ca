// The list of families whose motors can be found and set, and what they have in common.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "common/config_error.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {

namespace {

/// An angle this near to 0 is one that has just been set to 0.
constexpr double kAtZero_rad = 0.01;

}  // namespace

extern const MotorTool* const kDamiaoTool;
extern const MotorTool* const kRobstrideTool;
extern const MotorTool* const kMyactuatorTool;
extern const MotorTool* const kMoteusTool;
extern const MotorTool* const kCanopenTool;

std::span<const MotorTool* const> all_tools() noexcept {
  static const std::array kAll = {kDamiaoTool, kRobstrideTool, kMyactuatorTool, kMoteusTool,
                                  kCanopenTool};
  return kAll;
}

void MotorTool::require_number(Wire* wire, int wanted, bool fd) const {
  const auto there = [&](const CanFrame& answer) {
    const auto motor = found(answer);
    return motor && motor->number == wanted;
  };
  if (!wire->ask(presence(wanted, fd), there))
    throw std::runtime_error(fmt::format("number {} does not answer", wanted));
}

void MotorTool::require_zero(double angle_rad) {
  if (!(std::abs(angle_rad) < kAtZero_rad))
    throw std::runtime_error(fmt::format("its angle is {:g} rad, not 0", angle_rad));
}

const MotorTool& tool_of(const std::string& protocol) {
  std::string words;
  for (const MotorTool* tool : all_tools()) {
    if (tool->protocol() == protocol) return *tool;
    words += (words.empty() ? "" : ", ") + std::string(tool->protocol());
  }
  throw ConfigError("no family '" + protocol + "'; there are " + words);
}

}  // namespace limber::motor_tools
