// A Cartesian stiffness in joint coordinates.
#include "controller/impedance/stiffness_mapping.h"
#include "controller/model/pose_error.h"
#include "lecture/eval/choices.h"
#include "lecture/eval/law_run.h"

namespace limber::eval {
using namespace controller;

Json eq4(Arm& arm, Inputs& in) {
  const VectorJ q = in.vector("q", arm.size());
  const Pose tip = arm.model.tip_pose(q);
  const Pose goal = arm.goal(in, tip);
  const Matrix6 K_x = arm.task.embed(in.symmetric("Kx", arm.task.size()));
  const Orientation mode = orientation(in);
  const PoseError error = pose_error(tip, goal, mode);
  const Matrix6J J = arm.model.jacobian(q);
  const Vector6 W = error.A.transpose() * (K_x * error.e);
  return {{"first", rows_of(first_term(J, error, K_x))},
          {"geometric_fixed_wrench", rows_of(geometric_term(J, W))},
          {"full", rows_of(full_tangent(&arm.model, q, goal, K_x, mode))}};
}

Json eq7(Arm& arm, Inputs& in) {
  LawRun run(&arm, "mapped_joint_impedance", in);
  run.goal.q_d = in.vector("q_d", arm.size());
  run.goal.v_d = in.vector_or_zero("v_d", arm.size());
  run.goal.X_BD = arm.goal(in, run.terms.X_BT);
  run.gains.K_x = arm.task.embed(in.symmetric("Kx", arm.task.size()));
  run.gains.D_x = arm.task.embed(in.symmetric("Dx", arm.task.size()));
  LawSettings& settings = run.gains.settings;
  settings.stiffness_terms =
      in.choice<StiffnessTerms>("which", {{"first", StiffnessTerms::kFirst},
                                          {"first+geometric", StiffnessTerms::kGeometric},
                                          {"full", StiffnessTerms::kFull}});
  const auto pose = in.choice<MappingPose>("pose", {{"current", MappingPose::kCurrent},
                                                    {"desired", MappingPose::kGoal},
                                                    {"mid", MappingPose::kMid},
                                                    {"mean", MappingPose::kMean}});
  run.set("stiffness_pose", static_cast<double>(pose));
  settings.orientation = orientation(in);
  run.set("follow_velocity", in.flag("use_vd", true) ? 1.0 : 0.0);
  settings.model_compensation = model_compensation(in);
  const VectorJ tau = run.torque();
  const MappedGains gains = mapped_gains(&arm.model, run.point.q, run.point.v, run.goal, run.gains,
                                         run.gains.D_x, {pose, DampingPartials::kNone});
  return {{"tau", list_of(tau)}, {"Kp", rows_of(gains.K_p)}, {"Kv", rows_of(gains.K_v)}};
}

}  // namespace limber::eval
