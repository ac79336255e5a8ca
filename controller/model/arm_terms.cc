#include "controller/model/arm_terms.h"

#include "dynamics/spd_solve.h"
#include "robots/loader/load_robot.h"

namespace limber::controller {
namespace {

std::vector<double> rotor_inertias(const Robot& robot) {
  std::vector<double> inertias;
  for (const JointConfig& joint : robot.joints) {
    double B = joint.apparent_rotor_inertia_kgm2();
    if (joint.has_antagonist)
      B += joint.antagonist.rotor_inertia_kgm2 / joint.torque_loop.inertia_ratio;
    inertias.push_back(B);
  }
  return inertias;
}

}  // namespace

ArmTerms::ArmTerms(int joints)
    : V_BT(Vector6::Zero()),
      J(Matrix6J::Zero(6, joints)),
      Jdot_v(Vector6::Zero()),
      M(MatrixJ::Identity(joints, joints)),
      B(VectorJ::Zero(joints)),
      M_total(MatrixJ::Identity(joints, joints)),
      Minv_JT(MatrixJ6::Zero(joints, 6)),
      Cv(VectorJ::Zero(joints)),
      CTv(Cv),
      g(Cv),
      g_slope(Cv) {}

ArmModel::ArmModel(const KDL::Chain& chain, const double gravity[3],
                   const std::vector<double>& rotor_inertia)
    : rotor_inertia_(Eigen::Map<const Eigen::VectorXd>(
          rotor_inertia.data(), static_cast<Eigen::Index>(rotor_inertia.size()))),
      zero_(VectorJ::Zero(rotor_inertia_.size())),
      size_(static_cast<int>(rotor_inertia_.size())),
      kernel_(dynamics::arm_kernel(dynamics::body_chain(chain, size_), Eigen::Vector3d(gravity))) {}

ArmModel::ArmModel(const LoadedRobot& robot)
    : ArmModel(robot.chain, robot.robot.gravity, rotor_inertias(robot.robot)) {}

void ArmModel::evaluate(const VectorJ& q, const VectorJ& v, ArmTerms* terms) noexcept {
  evaluate(q, v, TermsDue{}, terms);
}

void ArmModel::evaluate(const VectorJ& q, const VectorJ& v, const TermsDue& due,
                        ArmTerms* terms) noexcept {
  kernel_->place(q);
  kernel_->gravity(&terms->g, &terms->g_slope);
  terms->X_BT = placed_tip();
  if (due.jacobian) kernel_->jacobian(&terms->J);
  terms->V_BT.noalias() = terms->J * v;
  if (due.jacobian || due.coriolis) kernel_->move(v, zero_);
  if (due.jacobian) terms->Jdot_v = kernel_->tip_acceleration(terms->V_BT);
  if (due.inertia || due.coriolis) kernel_->weigh();
  if (due.inertia) kernel_->mass(&terms->M);
  if (due.coriolis) kernel_->torque(&terms->Cv, &terms->CTv);
  if (due.inertia) {
    terms->B = rotor_inertia_;
    terms->M_total = terms->M;
    terms->M_total.diagonal() += terms->B;
  }
  if (due.inertia || due.jacobian) {
    Matrix6 G;
    dynamics::solve_spd(terms->M_total, terms->J, &terms->Minv_JT, &G);
    terms->tip = due.tip_inertia ? TipInertia(G) : TipInertia();
    terms->tip.G = G;
  }
}

Pose ArmModel::placed_tip() const noexcept {
  return {kernel_->tip_position(), Eigen::Quaterniond(kernel_->tip_rotation())};
}

Pose ArmModel::tip_pose(const VectorJ& q) noexcept { return tip(q).X_BT; }

Matrix6J ArmModel::jacobian(const VectorJ& q) noexcept { return tip(q).J; }

ArmModel::Tip ArmModel::tip(const VectorJ& q) noexcept {
  Tip tip{Pose(), Matrix6J(6, size_)};
  kernel_->place(q);
  tip.X_BT = placed_tip();
  kernel_->jacobian(&tip.J);
  return tip;
}

Vector6 ArmModel::jacobian_rate(const VectorJ& q, const VectorJ& v) noexcept {
  kernel_->place(q);
  kernel_->move(v, zero_);
  return kernel_->tip_acceleration(kernel_->tip_twist());
}

MatrixJ ArmModel::mass(const VectorJ& q) noexcept {
  MatrixJ M(size_, size_);
  kernel_->place(q);
  kernel_->weigh();
  kernel_->mass(&M);
  return M;
}

VectorJ ArmModel::coriolis(const VectorJ& q, const VectorJ& v) noexcept {
  VectorJ Cv(size_), CTv(size_);
  kernel_->place(q);
  kernel_->weigh();
  kernel_->move(v, zero_);
  kernel_->torque(&Cv, &CTv);
  return Cv;
}

VectorJ ArmModel::inverse_dynamics(const VectorJ& q, const VectorJ& v, const VectorJ& a) noexcept {
  VectorJ tau(size_), CTv(size_), g(size_);
  kernel_->place(q);
  kernel_->weigh();
  kernel_->move(v, a);
  kernel_->torque(&tau, &CTv);
  kernel_->gravity(&g, nullptr);
  return tau + g + rotor_inertia_.cwiseProduct(a);
}

VectorJ ArmModel::gravity(const VectorJ& q) noexcept {
  VectorJ g(size_);
  kernel_->place(q);
  kernel_->gravity(&g, nullptr);
  return g;
}

MatrixJ ArmModel::gravity_gradient(const VectorJ& q) noexcept {
  MatrixJ slope(size_, size_);
  kernel_->place(q);
  kernel_->gravity_gradient(&slope);
  return slope;
}

void ArmModel::evaluate_statics(const VectorJ& q, ArmTerms* terms) noexcept {
  kernel_->place(q);
  terms->X_BT = placed_tip();
  kernel_->jacobian(&terms->J);
  kernel_->gravity(&terms->g, nullptr);
}

}  // namespace limber::controller
