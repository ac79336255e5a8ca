// The list of families whose motors can be found and set, and what they have in common.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
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
extern const MotorTool* const kCubemarsTool;
extern const MotorTool* const kOdriveTool;
extern const MotorTool* const kMoteusTool;
extern const MotorTool* const kCanopenTool;

std::span<const MotorTool* const> all_tools() noexcept {
  // Those that others could take for an order are known first; those that switch off others come
  // last.
  static const std::array kAll = {kOdriveTool, kDamiaoTool,  kRobstrideTool, kMyactuatorTool,
                                  kMoteusTool, kCanopenTool, kCubemarsTool};
  return kAll;
}

Range range_of(Format format) noexcept {
  constexpr double kLargest = std::numeric_limits<float>::max();
  switch (format) {
    case Format::kInt16:
      return {-0x8000, 0x7FFF};
    case Format::kUint8:
      return {0, 0xFF};
    case Format::kUint16:
      return {0, 0xFFFF};
    case Format::kUint32:
      return {0, 0xFFFFFFFF};
    default:
      return {-kLargest, kLargest};
  }
}

void MotorTool::write(Wire* /*wire*/, int /*number*/, const Setting& setting, double /*value*/,
                      bool /*fd*/) const {
  throw std::runtime_error(setting.name + ": its protocol writes no settings");
}
bool MotorTool::store(Wire* /*wire*/, int /*number*/, bool /*fd*/) const { return false; }

std::string MotorTool::set_bit_rate(Wire* /*wire*/, int /*number*/, const BitRate& /*rate*/,
                                    bool /*fd*/) const {
  throw std::runtime_error("its protocol sets no bit rate: use its maker's tool");
}

Wire::Accept MotorTool::comes_from(int number) const {
  return [this, number](const CanFrame& frame) {
    const auto motor = found(frame);
    return motor && motor->number == number;
  };
}

void MotorTool::require_number(Wire* wire, int wanted, bool fd) const {
  if (!wire->ask(presence(wanted, fd), comes_from(wanted)))
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
