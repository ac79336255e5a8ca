#include "tools/check/pose_report.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <variant>

#include "controller/output/joint_limits.h"

namespace limber {
namespace {

constexpr double kAtItsEdge = 0.005;  // of the travel

/// Torque of the walls on an arm that rests at q.
VectorJ wall_torque(const controller::JointLimits& limits, const VectorJ& q) {
  const auto n = static_cast<int>(q.size());
  controller::ArmState state(n);
  state.q = state.theta = q;
  return limits.walls(state, MatrixJ::Identity(n, n));
}

void tell_of_walls(const Scenario& scenario, const Robot& robot, std::vector<std::string>* notes) {
  const controller::JointLimits limits(robot);
  VectorJ q(robot.size());
  for (int i = 0; i < robot.size(); ++i) q[i] = scenario.start_q[static_cast<std::size_t>(i)];
  const VectorJ inside = wall_torque(limits, q);
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& joint = robot.joints[static_cast<std::size_t>(i)];
    const double travel = joint.position_max - joint.position_min;
    if (!std::isfinite(travel)) continue;
    const bool upper = q[i] > joint.position_min + 0.5 * travel;
    VectorJ further = q;
    further[i] += (upper ? kAtItsEdge : -kAtItsEdge) * travel;
    if (inside[i] == 0.0 && wall_torque(limits, further)[i] == 0.0) continue;
    const bool slides = joint.type == JointType::kPrismatic;
    const std::string where =
        fmt::format("start: {} at {:.4g}, {:.3g} {} from its end at {:.4g}", joint.name, q[i],
                    upper ? joint.position_max - q[i] : q[i] - joint.position_min,
                    slides ? "m" : "rad", upper ? joint.position_max : joint.position_min);
    notes->push_back(
        where + (inside[i] == 0.0
                     ? ": at the edge of its soft wall, which holds it back when it moves outwards"
                     : fmt::format(": in its soft wall, which pushes with {:.3g} {}",
                                   std::abs(inside[i]), slides ? "N" : "N m")));
  }
}

void tell_of_turns(const Scenario& scenario, const Robot& robot, std::vector<std::string>* notes) {
  std::vector<double> from = scenario.start_q;  // empty: not known
  for (const TimedMessage& timed : scenario.timeline) {
    const auto* goal = std::get_if<compliance_goal_t>(&timed.message);
    if (goal == nullptr || goal->kind == compliance_goal_t::GOAL_WRENCH) continue;
    if (goal->kind != compliance_goal_t::GOAL_JOINT) {
      from.clear();
      continue;
    }
    for (std::size_t i = 0; i < from.size(); ++i) {
      const double turn = goal->q[i] - from[i];
      if (robot.joints[i].type != JointType::kContinuous || std::abs(turn) <= std::numbers::pi)
        continue;
      const double whole = 2.0 * std::numbers::pi * std::round(turn / (2.0 * std::numbers::pi));
      notes->push_back(fmt::format(
          "goal at {:g} s: {} turns by {:+.4g} rad, from {:.4g} to {:.4g}, as joint angles count; "
          "the same direction of the link is reached by {:+.4g} rad: {:.4g}",
          static_cast<double>(timed.time_ns) * 1e-9, robot.joints[i].name, turn, from[i],
          goal->q[i], turn - whole, goal->q[i] - whole));
    }
    from.assign(goal->q, goal->q + robot.size());
  }
}

}  // namespace

std::vector<std::string> pose_notes(const Scenario& scenario, const Robot& robot) {
  std::vector<std::string> notes;
  if (robot.has_drives) tell_of_walls(scenario, robot, &notes);
  tell_of_turns(scenario, robot, &notes);
  return notes;
}

}  // namespace limber
