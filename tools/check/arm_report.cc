#include "tools/check/arm_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>

#include "common/config_error.h"
#include "drivers/bus_load.h"
#include "robots/loader/adapter.h"
#include "robots/loader/sample_pose.h"
#include "tools/check/chain_report.h"

namespace limber {
namespace {

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

/// With real motors: ideal ones are often described so.
void warn_of_steps(const Robot& robot, ArmReport* report) {
  constexpr double kMostShare = 0.5;  // of the torque limit, in one cycle
  if (robot.on_virtual_buses()) return;
  for (const JointConfig& joint : robot.joints) {
    const double step = joint.torque_rate_limit_Nm_per_s / robot.rate_hz;
    if (step <= kMostShare * joint.torque_limit_Nm) continue;
    report->warnings.push_back(fmt::format(
        "{}: its torque rate limit allows steps of {:.3g} in a cycle, with a torque limit of "
        "{:.3g}: the gate will pass almost any step",
        joint.name, step, joint.torque_limit_Nm));
  }
}

BusReport bus_report(const Robot& robot, int index) {
  BusReport report{expected_bus_load(robot, index),
                   predicted_bus_load(robot, index),
                   predicted_end_s(robot, index),
                   reply_window_s(robot),
                   {}};
  Robot other = robot;
  BusConfig& bus = other.buses[static_cast<std::size_t>(index)];
  for (std::size_t i = 0; i < kAdapters.size(); ++i) {
    bus.adapter = kAdapters[i].adapter;
    if (!bus.fd || kAdapters[i].fd) report.highest_rate_hz[i] = highest_rate_hz(other, index);
  }
  return report;
}

void add_buses(const Robot& robot, ArmReport* report) {
  for (int i = 0; i < static_cast<int>(robot.buses.size()); ++i) {
    checked_bus_load(robot, i);
    report->buses.push_back(bus_report(robot, i));
  }
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
  warn_of_steps(robot.robot, &report);
  for (std::string& warning : chain_warnings(robot.robot))
    report.warnings.push_back(std::move(warning));
  if (robot.robot.has_drives) add_buses(robot.robot, &report);
  return report;
}

}  // namespace limber
