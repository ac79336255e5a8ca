// Laws that follow a goal of the tip.
#include "controller/model/pose_error.h"
#include "lecture/eval/choices.h"
#include "lecture/eval/law_run.h"

namespace limber::eval {
namespace {

using namespace controller;

// The goal, the spring and the damper.
void read_impedance(Inputs& in, LawRun* run) {
  const Task& task = run->arm.task;
  run->goal.X_BD = run->arm.goal(in, run->terms.X_BT);
  run->gains.K_x = task.embed(in.symmetric("Kx", task.size()));
  run->gains.D_x = task.embed(in.symmetric("Dx", task.size()));
  run->gains.settings.orientation = orientation(in);
}

void read_motion(Inputs& in, LawRun* run) {
  const Task& task = run->arm.task;
  run->goal.V_BD = task.embed(in.vector_or_zero("V_d", task.size()));
  run->goal.A_BD = task.embed(in.vector_or_zero("A_d", task.size()));
  run->goal.F_ff = task.embed(in.vector_or_zero("F_ff", task.size()));
}

}  // namespace

Json cartesian_impedance(Arm& arm, Inputs& in) {
  LawRun run(&arm, "cartesian_impedance", in);
  read_impedance(in, &run);
  read_motion(in, &run);
  run.gains.settings.model_compensation = model_compensation(in);
  run.set("inertia_feedforward", in.flag("inertia_ff", false) ? 1.0 : 0.0);
  const VectorJ tau = run.torque();
  const PoseError error = pose_error(run.terms.X_BT, run.goal.X_BD, run.gains.settings.orientation);
  return {{"tau", list_of(tau)},
          {"e", list_of(arm.task.of(error.e))},
          {"F_c", list_of(arm.task.of(run.output.F))}};
}

Json opspace_impedance(Arm& arm, Inputs& in) {
  LawRun run(&arm, "opspace_impedance", in);
  read_impedance(in, &run);
  read_motion(in, &run);
  const Task& task = arm.task;
  run.gains.M_x = task.embed(in.positive_definite("Md", task.size()));
  run.estimates.F_ext = task.embed(in.vector_or_zero("F_ext", task.size()));
  const VectorJ tau = run.torque();
  // The acceleration this torque and the contact give the tip.
  const ArmTerms& terms = run.terms;
  const VectorJ effort = tau - terms.Cv - terms.g + terms.J.transpose() * run.estimates.F_ext;
  const Vector6 a = terms.Minv_JT.transpose() * effort + terms.Jdot_v;
  return {{"tau", list_of(tau)}, {"a_ref", list_of(task.of(a))}};
}

Json accel_feedback(Arm& arm, Inputs& in) {
  LawRun run(&arm, "accel_feedback", in);
  read_impedance(in, &run);
  const Task& task = arm.task;
  run.gains.M_x = task.embed(in.symmetric("Mx", task.size()));
  run.estimates.A_BT = task.embed(in.vector("V_meas_dot", task.size()));
  run.gains.settings.model_compensation = model_compensation(in);
  return {{"tau", list_of(run.torque())}};
}

}  // namespace limber::eval
