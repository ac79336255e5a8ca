// Own source file: what it includes takes minutes to compile.
#include "qa/bench/pinocchio_peer.h"

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>
#include <string>

namespace limber::bench {

struct PinocchioPeer::Data {
  explicit Data(const pinocchio::Model& made) : model(made), data(model) {}
  pinocchio::Model model;
  pinocchio::Data data;
};

namespace {

pinocchio::Model make_model(const dynamics::BodyChain& chain, const Eigen::Vector3d& gravity) {
  pinocchio::Model model;
  model.gravity.linear() = gravity;
  pinocchio::JointIndex last = 0;
  for (const dynamics::Body& body : chain.bodies) {
    const pinocchio::SE3 placement(body.R, body.p);
    const std::string name = "j" + std::to_string(last);
    last = body.prismatic ? model.addJoint(last, pinocchio::JointModelPZ(), placement, name)
                          : model.addJoint(last, pinocchio::JointModelRZ(), placement, name);
    model.appendBodyToJoint(last,
                            pinocchio::Inertia(body.mass.mass, body.mass.com, body.mass.inertia),
                            pinocchio::SE3::Identity());
  }
  return model;
}

}  // namespace

PinocchioPeer::PinocchioPeer(const dynamics::BodyChain& chain, const Eigen::Vector3d& gravity)
    : J(6, static_cast<Eigen::Index>(chain.bodies.size())),
      data_(std::make_unique<Data>(make_model(chain, gravity))),
      R_tip_(chain.frames.back().R),
      p_tip_(chain.frames.back().p),
      gravity_(gravity) {}

PinocchioPeer::~PinocchioPeer() = default;

void PinocchioPeer::evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  const pinocchio::Model& model = data_->model;
  pinocchio::Data& data = data_->data;
  pinocchio::nonLinearEffects(model, data, q, v);
  const auto last = static_cast<std::size_t>(model.njoints - 1);
  // In the last body's axes, at its origin, with gravity's part.
  const Eigen::Vector3d a = data.a_gf[last].linear(), alpha = data.a_gf[last].angular();
  const Eigen::Vector3d v_O = data.v[last].linear(), w = data.v[last].angular();
  pinocchio::crba(model, data, q, pinocchio::Convention::WORLD);
  const Eigen::Matrix3d& R_body = data.oMi[last].rotation();
  R.noalias() = R_body * R_tip_;
  p.noalias() = data.oMi[last].translation() + R_body * p_tip_;
  for (Eigen::Index i = 0; i < J.cols(); ++i) {
    const Eigen::Vector3d z = data.J.col(i).tail<3>();
    J.col(i) << data.J.col(i).head<3>() + z.cross(p), z;
  }
  const Eigen::Vector3d at_tip = a + alpha.cross(p_tip_) + w.cross(v_O + w.cross(p_tip_));
  Jdot_v << R_body * at_tip + gravity_, R_body * alpha;
}

const Eigen::MatrixXd& PinocchioPeer::M() const { return data_->data.M; }
const Eigen::VectorXd& PinocchioPeer::nle() const { return data_->data.nle; }

}  // namespace limber::bench
