// Laws at the motor of an elastic joint, and such an arm's equations of motion.
#include "common/config_error.h"
#include "controller/elastic/full_state_feedback.h"
#include "controller/elastic/qbar.h"
#include "controller/elastic/tomei.h"
#include "lecture/eval/arm.h"
#include "lecture/eval/choices.h"
#include "lecture/eval/deflection_pd.h"
#include "lecture/eval/elastic_arm.h"
#include "lecture/eval/torque_feedback.h"

namespace limber::eval {
using namespace controller;

Json tomei(Arm& arm, Inputs& in) {
  const Eigen::Index n = arm.size();
  const VectorJ theta = in.vector("theta", n);
  const VectorJ theta_dot = in.vector_or_zero("thetad", n);
  const VectorJ q_d = in.vector("q_d", n);
  const Tomei law{.K_P = in.joint_matrix("KP", n),
                  .K_D = in.joint_matrix("KD", n),
                  .K_J = in.positive_diagonal("K", n)};
  const VectorJ g_d = arm.model.gravity(q_d);
  return {{"tau_m", list_of(law.torque(theta, theta_dot, q_d, g_d))},
          {"theta_d", list_of(law.theta_d(q_d, g_d))},
          {"lambda_min", law.lambda_min()}};
}

Json qbar(Arm& arm, Inputs& in) {
  const Eigen::Index n = arm.size();
  const VectorJ theta = in.vector("theta", n);
  const TipSpring spring{.X_BD = arm.goal(in, arm.model.tip_pose(theta)),
                         .K_x = arm.task.embed(in.symmetric("Kx", arm.task.size())),
                         .orientation = orientation(in)};
  QbarSolver solver(&arm.model, in.positive_diagonal("K", n));
  if (!solver.solve(theta, spring)) {
    throw ConfigError("there is no equilibrium to use: Kx is stiffer than the joint springs K");
  }
  return {{"qbar", list_of(solver.q_bar())}, {"u", list_of(solver.u())}};
}

Json flex_rhs(Arm& arm, Inputs& in) {
  const Eigen::Index n = arm.size();
  const ArmTerms terms = arm.terms(in);
  const ElasticJoints joints{.K_J = in.positive_diagonal("K", n),
                             .D_J = in.joint_diagonal("D", n),
                             .B = in.positive_diagonal("B", n)};
  const VectorJ q = in.vector("q", n);
  const VectorJ v = in.vector_or_zero("v", n);
  const VectorJ theta = in.vector("theta", n);
  const VectorJ theta_dot = in.vector_or_zero("thetad", n);
  const VectorJ tau_m = in.vector("tau_m", n);
  const VectorJ tau_f = in.vector_or_zero("tau_f", n);
  const Vector6 F_ext = arm.task.embed(in.vector_or_zero("F_ext", arm.task.size()));
  const ElasticArmRate rate =
      elastic_arm_rate(terms, joints, q, v, theta, theta_dot, tau_m, tau_f, F_ext);
  return {{"tau_spring", list_of(rate.tau)},
          {"tau_transmitted", list_of(rate.tau_t)},
          {"qdd", list_of(rate.qdd)},
          {"thetadd", list_of(rate.theta_dd)}};
}

Json torque_feedback(Inputs& in) {
  const Shape shape = in.shape("u");
  const TorqueFeedback law{.B = in.joint_diagonal("B", shape.size),
                           .B_theta = in.positive_diagonal("Btheta", shape.size),
                           .K_J = in.positive_diagonal("K", shape.size),
                           .D_J = in.joint_diagonal("D", shape.size)};
  const VectorJ u = in.joints("u", shape);
  const VectorJ tau = in.joints("tau", shape);
  return {{"tau_m", shape.value(law.torque(u, tau, in.joints("taud", shape)))}};
}

Json full_state(Inputs& in) {
  const Shape shape = in.shape("theta_err");
  const FullStateFeedback law{.K_P = in.joint_matrix("KP", shape.size),
                              .K_D = in.joint_matrix("KD", shape.size),
                              .K_T = in.joint_matrix("KT", shape.size),
                              .K_S = in.joint_matrix("KS", shape.size),
                              .K_J = in.positive_diagonal("K", shape.size)};
  const VectorJ theta_error = in.joints("theta_err", shape);
  const VectorJ theta_dot = in.joints("thetad", shape);
  const VectorJ tau = in.joints("tau", shape);
  const VectorJ tau_dot = in.joints("taud", shape);
  const VectorJ g = in.joints("g_ff", shape);
  return {{"tau_m", shape.value(law.torque(theta_error, theta_dot, tau, tau_dot, g))}};
}

Json deflection_pd(Inputs& in) {
  const Shape shape = in.shape("q");
  const MatrixJ K = in.joint_matrix("Kpm", shape.size);
  const MatrixJ D = in.joint_matrix("Kvm", shape.size);
  const VectorJ q = in.joints("q", shape);
  const VectorJ v = in.joints("v", shape);
  const VectorJ theta = in.joints("theta", shape);
  const VectorJ theta_dot = in.joints("thetad", shape);
  return {{"tau_m", shape.value(deflection_torque(K, D, q, v, theta, theta_dot))}};
}

}  // namespace limber::eval
