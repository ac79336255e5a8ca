#include "tools/check/arm_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>

#include "common/config_error.h"
#include "drivers/can/bus_load.h"
#include "robots/sample_pose.h"
#include "tools/check/chain_report.h"

namespace limber {
namespace {

constexpr double kPlannedLoad = 0.8;
constexpr double kRefusedLoad = 0.9;  // as the driver

KDL::JntArray to_kdl(const std::vector<double>& pose) {
  KDL::JntArray q(static_cast<unsigned>(pose.size()));
  for (std::size_t i = 0; i < pose.size(); ++i) q(static_cast<unsigned>(i)) = pose[i];
  return q;
}

double moving_mass(const KDL::Chain& chain) {
  double mass_kg = 0.0;
  bool moves = false;
  for (const KDL::Segment& segment : chain.segments) {
    moves = moves || segment.getJoint().getType() != KDL::Joint::Fixed;
    if (moves) mass_kg += segment.getInertia().getMass();
  }
  return mass_kg;
}

void add_home(const LoadedRobot& robot, const std::vector<double>& home, ArmReport* report) {
  KDL::Frame X_BT;
  KDL::ChainFkSolverPos_recursive(robot.chain).JntToCart(to_kdl(home), X_BT);
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
  X_BT.M.GetQuaternion(x, y, z, w);
  report->home_p_BT = {X_BT.p.x(), X_BT.p.y(), X_BT.p.z()};
  report->home_quat_BT = {w, x, y, z};
}

void add_gravity(const LoadedRobot& robot, const std::vector<double>& home, ArmReport* report) {
  const auto& g = robot.robot.gravity;
  KDL::ChainDynParam dynamics(robot.chain, KDL::Vector(g[0], g[1], g[2]));
  const std::size_t n = robot.robot.joints.size();
  KDL::JntArray torque(static_cast<unsigned>(n));
  dynamics.JntToGravity(to_kdl(home), torque);
  report->home_gravity_Nm.assign(torque.data.data(), torque.data.data() + n);
  report->worst_gravity_Nm.assign(n, 0.0);
  for (unsigned k = 0; k < kReportPoses; ++k) {
    dynamics.JntToGravity(to_kdl(sample_pose(robot.robot, k)), torque);
    for (std::size_t i = 0; i < n; ++i) {
      double& worst = report->worst_gravity_Nm[i];
      worst = std::max(worst, std::abs(torque(static_cast<unsigned>(i))));
    }
  }
}

void warn_of_gravity(const Robot& robot, ArmReport* report) {
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const JointConfig& joint = robot.joints[i];
    const double home = std::abs(report->home_gravity_Nm[i]);
    if (!(home <= joint.torque_limit_Nm)) {
      report->warnings.push_back(
          fmt::format("{}: gravity needs {:.3g} at home, more than the torque limit of {:.3g}",
                      joint.name, home, joint.torque_limit_Nm));
    } else if (!(report->worst_gravity_Nm[i] <= joint.torque_limit_Nm)) {
      report->warnings.push_back(fmt::format(
          "{}: gravity needs up to {:.3g} within the limits, more than the torque limit of {:.3g}: "
          "in such a pose the arm sinks",
          joint.name, report->worst_gravity_Nm[i], joint.torque_limit_Nm));
    }
  }
}

void add_buses(const Robot& robot, ArmReport* report) {
  std::string refused;
  for (int i = 0; i < static_cast<int>(robot.buses.size()); ++i) {
    const BusConfig& bus = robot.buses[static_cast<std::size_t>(i)];
    const BusReport figures{predicted_bus_load(robot, i),
                            highest_safe_rate_hz(robot, i, kPlannedLoad)};
    report->buses.push_back(figures);
    const std::string load = fmt::format(
        "bus '{}': {:.0f} % of the wire at {} Hz, every frame at its longest; {:.0f} Hz "
        "would be 80 %",
        bus.name, 100.0 * figures.load, robot.rate_hz, figures.highest_rate_hz);
    if (!(figures.load <= kRefusedLoad)) {
      refused += fmt::format("{}{}; lower rate_hz, use CAN-FD or more buses",
                             refused.empty() ? "" : "\n", load);
    } else if (!(figures.load <= kPlannedLoad)) {
      report->warnings.push_back(load);
    }
  }
  if (!refused.empty()) throw ConfigError(refused);
}

}  // namespace

ArmReport make_arm_report(const LoadedRobot& robot) {
  ArmReport report;
  report.moving_mass_kg = moving_mass(robot.chain);
  std::vector<double> home;
  for (const JointConfig& joint : robot.robot.joints) home.push_back(joint.home);
  add_home(robot, home, &report);
  add_gravity(robot, home, &report);
  warn_of_gravity(robot.robot, &report);
  for (std::string& warning : chain_warnings(robot.robot))
    report.warnings.push_back(std::move(warning));
  if (robot.robot.has_drives) add_buses(robot.robot, &report);
  return report;
}

}  // namespace limber
