// What is left beside the task, and damping that suits the inertia at the tip.
#include <limits>

#include "controller/impedance/damping_design.h"
#include "controller/impedance/nullspace.h"
#include "lecture/eval/law_run.h"

namespace limber::eval {
using namespace controller;

Json nullspace(Arm& arm, Inputs& in) {
  const Eigen::Index n = arm.size();
  ControlPoint point(arm.model.size());
  Goal goal(arm.model.size());
  Gains gains(arm.model.size(), {});
  const ArmTerms terms = arm.terms(in);
  point.q = in.vector("q", n);
  point.v = in.vector_or_zero("v", n);
  goal.q_null = in.vector("q_n", n);
  gains.K_null = in.joint_matrix("Kn", n);
  gains.D_null = in.joint_matrix("Dn", n);
  gains.settings.lost_share = kLostOnlyWhenSingular;
  gains.settings.projector = in.choice<Projector>(
      "projector", {{"dynamic", Projector::kDynamic}, {"kinematic", Projector::kKinematic}});
  const VectorJ unlimited = VectorJ::Constant(n, std::numeric_limits<double>::infinity());
  const TaskRows rows = arm.task.rows();
  const MatrixJ N =
      null_space_projector(terms, rows, gains.settings.projector, kLostOnlyWhenSingular);
  return {{"tau", list_of(null_space_torque(point, terms, goal, gains, rows, unlimited))},
          {"N", rows_of(N)}};
}

Json damping_design(Arm& arm, Inputs& in) {
  const Task& task = arm.task;
  const ArmTerms terms = arm.terms(in);
  const Matrix6 K_x = task.embed(in.positive_semidefinite("Kx", task.size()));
  const double zeta = in.not_negative("zeta");
  const TipMobility mobility = task_mobility(terms, task.rows());
  const Matrix6 Lambda = task_inertia(terms, task.rows(), kLostOnlyWhenSingular);
  const Matrix6 D = tip_damping(DampingDesign::kDoubleDiagonalisation, mobility, K_x, zeta);
  // Rows that are no part of the task have the least stiffness of all: zero.
  const Vector6 k_0 = modal_stiffness(mobility, K_x);
  return {{"Lambda", rows_of(task.of(Lambda))},
          {"D_double_diag", rows_of(task.of(D))},
          {"k0", list_of(k_0.tail(task.size()))},
          {"D_factorization", rows_of(task.of(factorised_tip_damping(mobility, K_x, zeta)))}};
}

}  // namespace limber::eval
