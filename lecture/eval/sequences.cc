// What has a memory: one value out for every sample in.
#include "controller/gains/energy_tank.h"
#include "controller/observers/admittance_filter.h"
#include "controller/observers/alpha_beta.h"
#include "controller/observers/filtered_difference.h"
#include "controller/observers/friction_observer.h"
#include "controller/observers/levant.h"
#include "controller/observers/momentum_observer.h"
#include "controller/output/torque_limiter.h"
#include "lecture/eval/arm.h"

namespace limber::eval {
using namespace controller;

Json admittance_seq(Inputs& in) {
  const Shape shape = in.sample_shape("F");
  AdmittanceFilter filter(in.symmetric_joint_matrix("M", shape.size),
                          in.symmetric_joint_matrix("D", shape.size),
                          in.symmetric_joint_matrix("K", shape.size), in.positive("T"));
  Json x = Json::array();
  Json v = Json::array();
  for (const VectorJ& F : in.samples("F", shape)) {
    filter.update(F);
    x.push_back(shape.value(filter.x()));
    v.push_back(shape.value(filter.v()));
  }
  return {{"x", x}, {"v", v}};
}

Json momentum_seq(Arm& arm, Inputs& in) {
  const Shape shape{static_cast<int>(arm.size()), false};
  MomentumObserver observer(in.positive_diagonal("KO", arm.size()), in.positive("T"));
  const std::vector<VectorJ> q = in.samples("q", shape);
  const std::vector<VectorJ> v = in.samples("v", shape, q.size());
  const std::vector<VectorJ> tau = in.samples("tau", shape, q.size());
  ArmTerms terms(arm.model.size());
  Json r = Json::array();
  for (std::size_t k = 0; k < q.size(); ++k) {
    arm.model.evaluate(q[k], v[k], &terms);
    const VectorJ beta = terms.CTv - terms.g;
    r.push_back(list_of(observer.update(terms.M_total * v[k], tau[k], beta)));
  }
  return {{"r", r}};
}

Json velocity_seq(Inputs& in) {
  const Shape shape = in.sample_shape("x");
  const double T = in.positive("T");
  const AlphaBetaGains gains(in.positive("sigma_a"), in.positive("sigma_x"), T);
  FilteredDifference<VectorJ> difference(shape.size, in.positive("wc"), T);
  AlphaBeta tracker(shape.size, gains, T);
  LevantDifferentiator levant(shape.size, in.positive("L"), T);
  Json out = {{"alpha", gains.alpha},
              {"beta", gains.beta},
              {"filtered_diff", Json::array()},
              {"alpha_beta", Json::array()},
              {"levant", Json::array()}};
  for (const VectorJ& x : in.samples("x", shape)) {
    out["filtered_diff"].push_back(shape.value(difference.update(x)));
    out["alpha_beta"].push_back(shape.value(tracker.update(x)));
    out["levant"].push_back(shape.value(levant.update(x)));
  }
  return out;
}

Json friction_seq(Inputs& in) {
  const Shape shape = in.sample_shape("thetad");
  FrictionObserver observer(in.positive_diagonal("B", shape.size),
                            in.positive_diagonal("L", shape.size), in.positive("T"));
  const std::vector<VectorJ> theta_dot = in.samples("thetad", shape);
  const std::vector<VectorJ> tau_m = in.samples("tau_m", shape, theta_dot.size());
  const std::vector<VectorJ> tau = in.samples("tau", shape, theta_dot.size());
  Json tau_f = Json::array();
  for (std::size_t k = 0; k < theta_dot.size(); ++k)
    tau_f.push_back(shape.value(observer.update(theta_dot[k], tau_m[k], tau[k])));
  return {{"tau_f", tau_f}};
}

Json tank_seq(Inputs& in) {
  const Shape shape = in.sample_shape("e");
  const EnergyTank::Config config{.E_0 = in.not_negative("E0"),
                                  .E_min = in.not_negative("Emin"),
                                  .E_max = in.not_negative("Emax"),
                                  .share = in.not_negative("share")};
  const double T = in.positive("T");
  const MatrixJ D = in.symmetric_joint_matrix("D", shape.size);
  const std::vector<VectorJ> e = in.samples("e", shape);
  const std::vector<VectorJ> V = in.samples("V", shape, e.size());
  const std::vector<MatrixJ> K_req = in.matrix_samples("K_req", shape, e.size());
  EnergyTank tank(config, K_req.front());
  Json K = Json::array();
  Json E = Json::array();
  for (std::size_t k = 0; k < e.size(); ++k) {
    tank.update(K_req[k], D, e[k], V[k], T);
    K.push_back(shape.scalar ? Json(tank.stiffness()(0, 0)) : rows_of(tank.stiffness()));
    E.push_back(tank.energy_J());
  }
  return {{"K", K}, {"E", E}};
}

Json limit_seq(Inputs& in) {
  const Shape shape = in.sample_shape("tau");
  TorqueLimiter limiter(in.not_negative_diagonal("tau_max", shape.size),
                        in.not_negative_diagonal("rate_max", shape.size));
  limiter.set_previous(in.joints("tau0", shape));
  const double T = in.positive("T");
  Json sent = Json::array();
  for (VectorJ& tau : in.samples("tau", shape)) {
    limiter.limit(T, &tau);
    sent.push_back(shape.value(tau));
  }
  return {{"tau", sent}};
}

}  // namespace limber::eval
