// The list of families whose motors can be found and set, and nothing else.
#include <array>

#include "common/config_error.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {

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

const MotorTool& tool_of(const std::string& protocol) {
  std::string words;
  for (const MotorTool* tool : all_tools()) {
    if (tool->protocol() == protocol) return *tool;
    words += (words.empty() ? "" : ", ") + std::string(tool->protocol());
  }
  throw ConfigError("no family '" + protocol + "'; there are " + words);
}

}  // namespace limber::motor_tools
