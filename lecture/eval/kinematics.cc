// Where the tip is, how it moves, what the arm weighs; pose errors; singularities.
#include "controller/impedance/stiffness_mapping.h"
#include "controller/model/pose_error.h"
#include "controller/model/singularity.h"
#include "lecture/eval/arm.h"
#include "lecture/eval/law_run.h"

namespace limber::eval {
namespace {

using namespace controller;

Json quaternion_list(const Eigen::Quaterniond& Q) {
  const double sign = Q.w() < 0.0 ? -1.0 : 1.0;
  return list_of(sign * Eigen::Vector4d(Q.w(), Q.x(), Q.y(), Q.z()));
}

}  // namespace

Json kin_dyn(Arm& arm, Inputs& in) {
  const ArmTerms terms = arm.terms(in);
  const Vector6 W = arm.task.embed(in.vector_or_zero("W", arm.task.size()));
  const Task& task = arm.task;
  return {{"p", list_of(terms.X_BT.p.head(task.position()))},
          {"R", rows_of(terms.X_BT.Q.toRotationMatrix())},
          {"quat_wxyz", quaternion_list(terms.X_BT.Q)},
          {"J", rows_of(task.of(terms.J))},
          {"Jdot_v", list_of(task.of(terms.Jdot_v))},
          {"M", rows_of(terms.M)},
          {"Cv", list_of(terms.Cv)},
          {"CTv", list_of(terms.CTv)},
          {"g", list_of(terms.g)},
          {"Lambda", rows_of(task.of(task_inertia(terms, task.rows(), kLostOnlyWhenSingular)))},
          {"KG", rows_of(geometric_term(terms.J, W))}};
}

Json pose_error(Arm& arm, Inputs& in) {
  const Pose tip = arm.model.tip_pose(in.vector("q", arm.size()));
  const Pose goal = arm.goal(in, tip);
  Json out = {{"e_p", list_of((tip.p - goal.p).head(arm.task.position()))}};
  if (arm.task.planar) return out;
  const auto add = [&](const char* name, Orientation orientation) {
    const PoseError error = controller::pose_error(tip, goal, orientation);
    out[std::string("e_") + name] = list_of(error.e.tail<3>());
    out[std::string("A_") + name] = rows_of(error.A.bottomRightCorner<3, 3>());
  };
  add("log", Orientation::kLog);
  add("quat", Orientation::kQuat);
  add("rpy", Orientation::kRollPitchYaw);
  return out;
}

Json singularity(Arm& arm, Inputs& in) {
  const Matrix6J J = arm.task.rows().of(arm.model.jacobian(in.vector("q", arm.size())));
  const double sigma_0 = in.positive("sigma0");
  const DampedInverse inverse = damped_inverse(J, sigma_0, in.not_negative("lam_max"));
  return {{"sigma_min", inverse.sigma_min},
          {"lam", inverse.lambda},
          {"J_damped_pinv", rows_of(arm.task.of(inverse.inverse))}};
}

}  // namespace limber::eval
