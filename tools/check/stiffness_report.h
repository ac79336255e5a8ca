// Whether the gains a scenario asks for are stable at the robot's rate, mode by mode.
#pragma once

#include <limber/compliance_gains_t.hpp>
#include <string>
#include <vector>

#include "controller/impedance/stability.h"
#include "robots/loader/load_robot.h"
#include "scenarios/loader/scenario.h"

namespace limber {

/// "ok" up to half of the stiffest, "close" above, "unstable" beyond it. NaN is unstable.
const char* verdict(double share);

struct StiffnessReport {
  double at_s = 0.0;                  ///< of the gains entry; 0 also for the gains of robot.yaml
  controller::StiffnessModes tip;     ///< of K_x
  controller::StiffnessModes joints;  ///< of K_q, for joint laws and for holding
  controller::StiffnessModes null_space;  ///< of K_null and D_null, beside K_x
  double springs = 0.0;  ///< K_x over the most that springs in the joints allow; 0 where none do
};

/// Gains of robot.yaml and of each entry, at the start pose.
std::vector<StiffnessReport> make_stiffness_reports(const Scenario& scenario,
                                                    const LoadedRobot& robot);
/// One line for each report with an unstable mode or damper, or a tip stiffer than its springs.
std::vector<std::string> stiffness_warnings(const std::vector<StiffnessReport>& reports,
                                            const Robot& robot);

std::string stiffness_text(const std::vector<StiffnessReport>& reports, double rate_hz);
std::string stiffness_json(const std::vector<StiffnessReport>& reports);

}  // namespace limber
