#include "lecture/eval/arm.h"

#include <utility>

#include "common/config_error.h"
#include "lecture/eval/shapes.h"

namespace limber::eval {
namespace {

using controller::ArmModel;
using controller::Pose;

bool turns_about_z(ArmModel* model, const VectorJ& q) {
  const Matrix6J J = model->jacobian(q);
  constexpr double kRounding = 1e-12;
  return J.row(5).cwiseAbs().isOnes(kRounding) && J.middleRows(2, 3).isZero(kRounding);
}

// Two parallel axes stay parallel: one pose tells, another makes sure.
Task task_of(ArmModel* model) {
  if (model->size() != 2) return {};
  return {turns_about_z(model, VectorJ::Zero(2)) && turns_about_z(model, VectorJ::Ones(2))};
}

LoadedRobot load(const Json& name) {
  if (name.is_string()) return load_robot(name.get<std::string>());
  if (!name.is_object()) refuse("robot", "a name, a folder or an object", name);
  Inputs in(name);
  const std::string urdf = in.text("urdf");
  const std::string base = in.text("base");
  const std::string tip = in.text("tip");
  Eigen::Vector3d gravity(0.0, 0.0, -9.81);
  if (in.has("gravity")) gravity = in.vector("gravity", 3);
  in.finish();
  return load_urdf(urdf, base, tip, gravity.data());
}

}  // namespace

Arm::Arm(LoadedRobot loaded) : robot(std::move(loaded)), model(robot), task(task_of(&model)) {}

controller::ArmTerms Arm::terms(Inputs& in) {
  controller::ArmTerms terms(model.size());
  const VectorJ q = in.vector("q", size());
  model.evaluate(q, in.vector_or_zero("v", size()), &terms);
  return terms;
}

Pose Arm::goal(Inputs& in, const Pose& like) const {
  Pose goal = like;
  goal.p.head(task.position()) = in.vector("p_d", task.position());
  if (!task.planar) goal.Q = in.rotation("R_d");
  return goal;
}

Arm& Arms::find(const Json* name) {
  const Json& wanted = name == nullptr ? default_arm_ : *name;
  if (wanted.is_null()) {
    throw ConfigError(
        "this law needs an arm: give the case a \"robot\", or start with --robot or "
        "--urdf");
  }
  std::unique_ptr<Arm>& arm = arms_[wanted.dump()];
  if (!arm) arm = std::make_unique<Arm>(load(wanted));
  return *arm;
}

}  // namespace limber::eval
