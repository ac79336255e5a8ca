// Joints with two motors, and the joint stiffnesses nearest to a Cartesian one.
#include "controller/elastic/vsa_stiffness.h"
#include "lecture/eval/arm.h"
#include "lecture/eval/vsa_pair.h"

namespace limber::eval {
using namespace controller;

Json vsa(Inputs& in) {
  const Shape shape = in.shape("sigma");
  const VectorJ sigma = in.positive_diagonal("sigma", shape.size);
  const VectorJ k_2 = in.positive_diagonal("k2", shape.size);
  const VectorJ tau = in.joints("tau", shape);
  const VectorJ q = in.joints("q", shape);
  VectorJ theta_1(shape.size);
  VectorJ theta_2(shape.size);
  VectorJ tau_check(shape.size);
  VectorJ sigma_check(shape.size);
  Json feasible = Json::array();
  for (Eigen::Index i = 0; i < shape.size; ++i) {
    const VsaJoint wanted{tau[i], sigma[i]};
    const VsaMotors motors = vsa_inverse(wanted, q[i], k_2[i]);
    const VsaJoint given = vsa_forward(motors, q[i], k_2[i]);
    theta_1[i] = motors.theta_1;
    theta_2[i] = motors.theta_2;
    tau_check[i] = given.tau;
    sigma_check[i] = given.sigma;
    feasible.push_back(vsa_feasible(wanted, k_2[i]));
  }
  return {{"theta1", shape.value(theta_1)},
          {"theta2", shape.value(theta_2)},
          {"feasible", shape.scalar ? feasible[0] : feasible},
          {"tau_check", shape.value(tau_check)},
          {"sigma_check", shape.value(sigma_check)}};
}

Json vsa_cartesian(Arm& arm, Inputs& in) {
  const Eigen::Index n = arm.size();
  const TaskJacobian J = arm.task.of(arm.model.jacobian(in.vector("q", n)));
  const TaskMatrix K_x = in.positive_definite("Kx", arm.task.size());
  const JointFit stiffness = nearest_joint_stiffness(J, K_x, MatrixJ::Zero(n, n));
  const JointFit compliance = nearest_joint_compliance(J, K_x);
  return {{"diag_stiffness", list_of(stiffness.value)},
          {"residual_stiffness", stiffness.residual},
          {"compliance", list_of(compliance.value)},
          {"residual_compliance_weighted", compliance.residual}};
}

}  // namespace limber::eval
