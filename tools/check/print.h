// limber-check's output: for people, or as one JSON object.
#pragma once

#include <string>
#include <vector>

#include "robots/loader/urdf_arms.h"
#include "scenarios/loader/scenario.h"
#include "tools/check/arm_report.h"

namespace limber {

std::string arm_text(const LoadedRobot& robot, const ArmReport& report);
std::string arm_json(const LoadedRobot& robot, const ArmReport& report);
std::string scenario_text(const Scenario& scenario, const LoadedRobot& robot);
std::string scenario_json(const Scenario& scenario, const LoadedRobot& robot);
/// The arms of a URDF, with the command that checks each.
std::string arms_text(const std::string& file, const std::vector<UrdfArm>& arms);
/// {"ok": false, "complaints": [problem], "chains": [...]}
std::string arms_json(const std::string& problem, const std::vector<UrdfArm>& arms);
/// The drive protocols (robots/loader/protocols), for tools in other languages.
std::string protocols_json();
/// {"ok": false, "complaints": [...]}, one a line of `what`.
std::string refusal_json(const std::string& what);

}  // namespace limber
