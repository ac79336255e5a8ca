// Whether the gains a scenario asks for are stable at the robot's rate, mode by mode.
#pragma once

#include <limber/compliance_gains_t.hpp>
#include <string>
#include <vector>

#include "robots/loader/load_robot.h"
#include "scenarios/loader/scenario.h"

namespace limber {

/// One mode of M s^2 + D s + K; K counts per unit of the mode's inertia, 1/s^2.
struct ModeReport {
  double frequency_rad_per_s = 0.0;  ///< natural, of the stiffness asked for
  double share = 0.0;                ///< stiffness asked for over the stiffest that is stable
};

/// "ok" up to half of the stiffest, "close" above, "unstable" beyond it. NaN is unstable.
const char* verdict(double share);

struct StiffnessReport {
  double at_s = 0.0;               ///< of the gains entry; 0 also for the gains of robot.yaml
  std::vector<ModeReport> tip;     ///< of K_x, softest first
  std::vector<ModeReport> joints;  ///< of K_q, for joint laws and for holding
};

/// The highest share of a list of modes; 0 if it is empty.
double highest_share(const std::vector<ModeReport>& modes);

/// Gains of robot.yaml and of each entry, at the start pose, with the one cycle that the torque
/// takes to the motor. Friction is left out, so an arm with it is more stable.
std::vector<StiffnessReport> make_stiffness_reports(const Scenario& scenario,
                                                    const LoadedRobot& robot);
/// One line for each report with an unstable mode.
std::vector<std::string> stiffness_warnings(const std::vector<StiffnessReport>& reports,
                                            double rate_hz);

std::string stiffness_text(const std::vector<StiffnessReport>& reports, double rate_hz);
std::string stiffness_json(const std::vector<StiffnessReport>& reports);

}  // namespace limber
