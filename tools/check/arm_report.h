// What limber-check says of an arm that has loaded: figures, and what a user should think about.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "robots/loader/adapter.h"
#include "robots/loader/load_robot.h"

namespace limber {

struct BusReport {
  double load = 0.0;       ///< share of the wire at the robot's rate, frames of the usual length
  double most_load = 0.0;  ///< every frame at its longest
  double end_s = 0.0;      ///< last reply after the start of a cycle, at the latest
  double window_s = 0.0;   ///< how long the driver waits for it
  std::array<double, kAdapters.size()> highest_rate_hz =
      {};  ///< by class of adapter; 0: it cannot carry the bus
};

struct ArmReport {
  double moving_mass_kg = 0.0;
  std::vector<double> home_p_BT;         ///< m
  std::vector<double> home_quat_BT;      ///< w, x, y, z
  std::vector<double> home_gravity_Nm;   ///< torque that holds the arm at home
  std::vector<double> worst_gravity_Nm;  ///< largest magnitude over kPoses poses within the limits
  std::vector<BusReport> buses;
  std::vector<std::string> warnings;
};

/// Poses that worst_gravity_Nm is taken over.
inline constexpr unsigned kReportPoses = 2000;

/// Throws ConfigError if a bus cannot carry the arm (the driver would refuse it too).
ArmReport make_arm_report(const LoadedRobot& robot);

}  // namespace limber
