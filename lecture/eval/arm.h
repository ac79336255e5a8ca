// The arm of a case, and how it is named.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "controller/model/arm_terms.h"
#include "lecture/eval/inputs.h"
#include "lecture/eval/task.h"
#include "robots/loader/load_robot.h"

namespace limber::eval {

struct Arm {
  explicit Arm(LoadedRobot loaded);

  Eigen::Index size() const noexcept { return model.size(); }
  /// Terms at the inputs q and v; v is zero if it is not given.
  controller::ArmTerms terms(Inputs& in);
  /// The input p_d and, unless the task is planar, R_d. A planar goal has the tip's orientation at
  /// `like`.
  controller::Pose goal(Inputs& in, const controller::Pose& like) const;

  LoadedRobot robot;
  controller::ArmModel model;
  Task task;
};

/// Loads each arm once. An arm is named by a shipped robot's name, by a folder, or by an object
/// {"urdf", "base", "tip", "gravity"}; gravity in m/s^2, axes of the URDF's root link, (0, 0,
/// -9.81) if it is not given. Paths are relative to the working directory.
class Arms {
 public:
  /// null: there is no arm for cases that name none.
  explicit Arms(Json default_arm) : default_arm_(std::move(default_arm)) {}

  /// Throws ConfigError.
  Arm& find(const Json* name);

 private:
  Json default_arm_;
  std::map<std::string, std::unique_ptr<Arm>> arms_;
};

}  // namespace limber::eval
