#include "sim/plant/check_setup.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "common/config_error.h"
#include "common/joints.h"

namespace limber::sim {
namespace {

template <typename... Args>
[[noreturn]] void refuse(const Robot& robot, fmt::format_string<Args...> text, Args&&... args) {
  throw ConfigError(robot.name + ": " + fmt::format(text, std::forward<Args>(args)...));
}

void check_bus(const Robot& robot, const JointConfig& joint, int bus) {
  if (bus >= 0 && bus < static_cast<int>(robot.buses.size())) return;
  refuse(robot, "joint {} is on bus number {}, which does not exist", joint.name, bus);
}

}  // namespace

void check_setup(const Robot& robot, std::size_t buses, double step_s) {
  if (!robot.has_drives)
    refuse(robot, "has no drives (no robot.yaml), so there is nothing to simulate on a bus");
  if (robot.size() < 1 || robot.size() > kMaxJoints) {
    refuse(robot, "has {} joints; 1 to {} are allowed", robot.size(), kMaxJoints);
  }
  if (buses != robot.buses.size() || buses == 0 || buses > kMaxBuses) {
    refuse(robot, "needs its {} buses, 1 to {} are allowed, {} given", robot.buses.size(),
           kMaxBuses, buses);
  }
  if (!(step_s >= 1e-6 && step_s <= 0.01)) {
    refuse(robot, "integration step {} s; allowed: 1e-6 to 0.01", step_s);
  }
  if (!(robot.rate_hz >= 1.0 && robot.rate_hz <= 1e5))
    refuse(robot, "rate {} Hz; allowed: 1 to 1e5", robot.rate_hz);
  if (robot.has_tip_sensor && !(robot.tip_sensor.bus < static_cast<int>(buses)))
    refuse(robot, "the tip sensor is on bus number {}, which does not exist", robot.tip_sensor.bus);
  for (const JointConfig& joint : robot.driven()) {
    check_bus(robot, joint, joint.drive.bus);
    if (joint.has_antagonist) check_bus(robot, joint, joint.antagonist.bus);
  }
}

void check_plant(const Robot& robot, const Robot& plant) {
  bool same = robot.size() == plant.size() && robot.has_tip_sensor == plant.has_tip_sensor &&
              robot.hand.has_value() == plant.hand.has_value();
  for (int i = 0; same && i < robot.size(); ++i) {
    same = robot.joints[i].has_antagonist == plant.joints[i].has_antagonist;
  }
  if (!same)
    refuse(robot, "its plant has other joints, motors, tip sensor or hand; the same are needed");
}

VectorJ start_position(const Robot& robot, const std::vector<double>& start_q) {
  if (!start_q.empty() && static_cast<int>(start_q.size()) != robot.size()) {
    refuse(robot, "the start has {} joints, the robot {}", start_q.size(), robot.size());
  }
  VectorJ q(robot.size());
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& joint = robot.joints[i];
    q[i] = start_q.empty() ? joint.home : start_q[i];
    if (!(q[i] >= joint.position_min && q[i] <= joint.position_max) || !std::isfinite(q[i])) {
      refuse(robot, "start of {} at {}; allowed: {} to {}", joint.name, q[i], joint.position_min,
             joint.position_max);
    }
  }
  return q;
}

}  // namespace limber::sim
