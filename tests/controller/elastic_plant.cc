#include "tests/controller/elastic_plant.h"

namespace limber::testing {

ElasticPlant::ElasticPlant(const LoadedRobot& robot)
    : q(VectorJ::Zero(robot.robot.size())),
      v(q),
      theta(q),
      theta_dot(q),
      c(q),
      c_dot(q),
      tau_f(q),
      model_(robot),
      terms_(model_.size()),
      K_(q),
      k2_(q),
      D_(q),
      B_(q),
      preload_(q) {
  for (int i = 0; i < robot.robot.size(); ++i) {
    const JointConfig& joint = robot.robot.joints[static_cast<std::size_t>(i)];
    K_[i] = joint.transmission.spring.stiffness_Nm_per_rad;
    k2_[i] = joint.transmission.spring.k2_Nm_per_rad2;
    D_[i] = joint.transmission.damping_Nms_per_rad;
    B_[i] = joint.motors() * joint.apparent_rotor_inertia_kgm2();
    preload_[i] = joint.transmission.preload_rad;
  }
}

void ElasticPlant::rest_at(const VectorJ& q_at) {
  q = q_at;
  c = 0.5 * preload_;
  const VectorJ g = model_.gravity(q);
  for (Eigen::Index i = 0; i < q.size(); ++i) theta[i] = q[i] + g[i] / stiffness(i);
}

void ElasticPlant::advance(double dt, const VectorJ& tau, const VectorJ& tau_preload) {
  constexpr int kSteps = 10;
  model_.evaluate(q, v, &terms_);
  const Eigen::LLT<MatrixJ> M(terms_.M);
  for (int i = 0; i < kSteps; ++i) step(dt / kSteps, M, tau, tau_preload);
}

void ElasticPlant::step(double h, const Eigen::LLT<MatrixJ>& M, const VectorJ& tau,
                        const VectorJ& tau_preload) {
  VectorJ tau_t = D_.cwiseProduct(theta_dot - v);
  for (Eigen::Index i = 0; i < q.size(); ++i) tau_t[i] += joint_torque(i);
  const VectorJ a = M.solve(VectorJ(tau_t - terms_.Cv - terms_.g + terms_.J.transpose() * F_ext));
  // f(c + x) + f(c - x) of quadratic springs.
  const VectorJ x = theta - q;
  const VectorJ pull = k2_.cwiseProduct(c.cwiseAbs2() + x.cwiseAbs2());
  v += h * a;
  theta_dot += h * (tau - tau_f - tau_t).cwiseQuotient(B_);
  c_dot += h * (tau_preload - pull).cwiseQuotient(B_);
  c_dot = k2_.cwiseSign().cwiseProduct(c_dot);  // joints with one motor have no preload
  q += h * v;
  theta += h * theta_dot;
  c += h * c_dot;
}

}  // namespace limber::testing
