#include "controller/arm_terms.h"

#include <Eigen/Cholesky>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <string>

#include "common/config_error.h"

namespace limber::controller {
namespace {

std::vector<double> rotor_inertias(const Robot& robot) {
  std::vector<double> inertias;
  for (const JointConfig& joint : robot.joints) inertias.push_back(joint.drive.rotor_inertia_kgm2);
  return inertias;
}

int checked_size(const KDL::Chain& chain, std::size_t expected) {
  const unsigned joints = chain.getNrOfJoints();
  if (joints < 1 || joints > static_cast<unsigned>(kMaxJoints) || joints != expected) {
    throw ConfigError("the chain from base to tip has " + std::to_string(joints) +
                      " moving joints; the robot names " + std::to_string(expected) +
                      ", and 1 to " + std::to_string(kMaxJoints) + " are allowed");
  }
  return static_cast<int>(joints);
}

Vector6 six(const KDL::Twist& twist) noexcept {
  Vector6 result;
  for (int i = 0; i < 6; ++i) result[i] = twist[i];
  return result;
}

Pose pose_of(const KDL::Frame& frame) noexcept {
  Pose pose;
  pose.p << frame.p.x(), frame.p.y(), frame.p.z();
  frame.M.GetQuaternion(pose.Q.x(), pose.Q.y(), pose.Q.z(), pose.Q.w());
  return pose;
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
      g(VectorJ::Zero(joints)) {}

// KDL works on heap-allocated arrays; these are sized once.
struct ArmModel::Solvers {
  Solvers(const KDL::Chain& given, const KDL::Vector& gravity)
      : chain(given),
        position(chain),
        jacobian(chain),
        jacobian_rate(chain),
        dynamics(chain, gravity),
        q(chain.getNrOfJoints()),
        qv(chain.getNrOfJoints()),
        vector(chain.getNrOfJoints()),
        J(chain.getNrOfJoints()),
        M(chain.getNrOfJoints()) {}

  KDL::Chain chain;  // the solvers keep references to it
  KDL::ChainFkSolverPos_recursive position;
  KDL::ChainJntToJacSolver jacobian;
  KDL::ChainJntToJacDotSolver jacobian_rate;
  KDL::ChainDynParam dynamics;
  KDL::JntArray q;
  KDL::JntArrayVel qv;
  KDL::JntArray vector;
  KDL::Jacobian J;
  KDL::JntSpaceInertiaMatrix M;
};

ArmModel::ArmModel(const KDL::Chain& chain, const double gravity[3],
                   const std::vector<double>& rotor_inertia)
    : size_(checked_size(chain, rotor_inertia.size())),
      rotor_inertia_(Eigen::Map<const Eigen::VectorXd>(rotor_inertia.data(), size_)),
      solvers_(std::make_unique<Solvers>(chain, KDL::Vector(gravity[0], gravity[1], gravity[2]))) {
  ArmTerms probe(size_);
  // KDL's error codes come from sizes and structure alone: right here, right for ever.
  const int error = evaluate_kdl(VectorJ::Zero(size_), VectorJ::Zero(size_), &probe);
  if (error != KDL::SolverI::E_NOERROR) {
    throw ConfigError("the kinematic chain cannot be solved (KDL error " + std::to_string(error) +
                      ")");
  }
}

ArmModel::ArmModel(const LoadedRobot& robot)
    : ArmModel(robot.chain, robot.robot.gravity, rotor_inertias(robot.robot)) {}

ArmModel::~ArmModel() = default;

int ArmModel::evaluate_kdl(const VectorJ& q, const VectorJ& v, ArmTerms* terms) noexcept {
  Solvers& s = *solvers_;
  s.q.data = q;
  s.qv.q.data = q;
  s.qv.qdot.data = v;

  KDL::Frame frame;
  int error = s.position.JntToCart(s.q, frame);
  terms->X_BT = pose_of(frame);
  if (error == 0) error = s.jacobian.JntToJac(s.q, s.J);
  terms->J = s.J.data;
  KDL::Twist jdot_v;
  if (error == 0) error = s.jacobian_rate.JntToJacDot(s.qv, jdot_v);
  terms->Jdot_v = six(jdot_v);

  if (error == 0) error = s.dynamics.JntToMass(s.q, s.M);
  terms->M = s.M.data;
  if (error == 0) error = s.dynamics.JntToCoriolis(s.q, s.qv.qdot, s.vector);
  terms->Cv = s.vector.data;
  if (error == 0) error = s.dynamics.JntToGravity(s.q, s.vector);
  terms->g = s.vector.data;
  return error;
}

void ArmModel::evaluate(const VectorJ& q, const VectorJ& v, ArmTerms* terms) noexcept {
  evaluate_kdl(q, v, terms);
  terms->V_BT.noalias() = terms->J * v;
  terms->B = rotor_inertia_;
  terms->M_total = terms->M;
  terms->M_total.diagonal() += terms->B;
  terms->Minv_JT = terms->J.transpose();
  terms->M_total.llt().solveInPlace(terms->Minv_JT);
}

Pose ArmModel::tip_pose(const VectorJ& q) noexcept {
  solvers_->q.data = q;
  KDL::Frame frame;
  solvers_->position.JntToCart(solvers_->q, frame);
  return pose_of(frame);
}

void ArmModel::inertia(const VectorJ& q, MatrixJ* M) noexcept {
  solvers_->q.data = q;
  solvers_->dynamics.JntToMass(solvers_->q, solvers_->M);
  *M = solvers_->M.data;
}

void ArmModel::gravity(const VectorJ& q, VectorJ* g) noexcept {
  solvers_->q.data = q;
  solvers_->dynamics.JntToGravity(solvers_->q, solvers_->vector);
  *g = solvers_->vector.data;
}

void ArmModel::evaluate_statics(const VectorJ& q, ArmTerms* terms) noexcept {
  terms->X_BT = tip_pose(q);
  solvers_->jacobian.JntToJac(solvers_->q, solvers_->J);
  terms->J = solvers_->J.data;
  gravity(q, &terms->g);
}

}  // namespace limber::controller
