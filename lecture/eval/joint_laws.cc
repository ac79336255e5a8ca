// Laws that follow a goal of the joints.
#include <Eigen/Cholesky>

#include "lecture/eval/choices.h"
#include "lecture/eval/law_run.h"

namespace limber::eval {
namespace {

using namespace controller;

void read_joint_goal(Inputs& in, LawRun* run) {
  const Eigen::Index n = run->arm.size();
  run->goal.q_d = in.vector("q_d", n);
  run->goal.v_d = in.vector_or_zero("v_d", n);
}

void read_moving_goal(Inputs& in, LawRun* run) {
  read_joint_goal(in, run);
  run->goal.a_d = in.vector_or_zero("a_d", run->arm.size());
}

}  // namespace

Json joint_pd(Arm& arm, Inputs& in) {
  LawRun run(&arm, "joint_pd", in);
  read_joint_goal(in, &run);
  run.gains.K_q = in.joint_matrix("Kp", arm.size());
  run.gains.D_q = in.joint_matrix("Kv", arm.size());
  run.gains.settings.model_compensation = model_compensation(in);
  return {{"tau", list_of(run.torque())}};
}

Json salisbury(Arm& arm, Inputs& in) {
  LawRun run(&arm, "salisbury", in);
  read_joint_goal(in, &run);
  run.gains.K_x = arm.task.embed(in.symmetric("Kx", arm.task.size()));
  run.gains.D_q = in.joint_matrix("Kv", arm.size());
  run.gains.settings.model_compensation = model_compensation(in);
  const MatrixJ K_q = run.terms.J.transpose() * run.gains.K_x * run.terms.J;
  return {{"tau", list_of(run.torque())}, {"Kq", rows_of(K_q)}};
}

Json computed_torque(Arm& arm, Inputs& in) {
  LawRun run(&arm, "computed_torque", in);
  read_moving_goal(in, &run);
  run.set("K_acc_per_s2", in.joint_matrix("Kp_acc", arm.size()));
  run.set("D_acc_per_s", in.joint_matrix("Kv_acc", arm.size()));
  return {{"tau", list_of(run.torque())}};
}

Json pd_plus(Arm& arm, Inputs& in) {
  LawRun run(&arm, "pd_plus", in);
  read_moving_goal(in, &run);
  run.gains.K_q = in.joint_matrix("Kp", arm.size());
  run.gains.D_q = in.joint_matrix("Kv", arm.size());
  return {{"tau", list_of(run.torque())}};
}

Json joint_impedance(Arm& arm, Inputs& in) {
  LawRun run(&arm, "joint_impedance", in);
  read_moving_goal(in, &run);
  run.set("M_q_kgm2", in.positive_definite_joint_matrix("Md", arm.size()));
  run.gains.D_q = in.joint_matrix("Bd", arm.size());
  run.gains.K_q = in.joint_matrix("Kd", arm.size());
  run.estimates.tau_ext = in.vector_or_zero("tau_ext", arm.size());
  const VectorJ tau = run.torque();
  // The acceleration this torque and the contact give the arm.
  const VectorJ effort = tau - run.terms.Cv - run.terms.g + run.estimates.tau_ext;
  return {{"tau", list_of(tau)}, {"a_ref", list_of(run.terms.M_total.llt().solve(effort))}};
}

}  // namespace limber::eval
