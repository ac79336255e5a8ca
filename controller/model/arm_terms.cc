#include "controller/model/arm_terms.h"

#include <Eigen/Cholesky>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <string>

#include "common/config_error.h"

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
        newton_euler(chain, gravity),
        q(chain.getNrOfJoints()),
        qv(chain.getNrOfJoints()),
        vector(chain.getNrOfJoints()),
        J(chain.getNrOfJoints()),
        a(chain.getNrOfJoints()),
        M(chain.getNrOfJoints()),
        no_wrench(chain.getNrOfSegments(), KDL::Wrench::Zero()) {}

  KDL::Chain chain;  // the solvers keep references to it
  KDL::ChainFkSolverPos_recursive position;
  KDL::ChainJntToJacSolver jacobian;
  KDL::ChainJntToJacDotSolver jacobian_rate;
  KDL::ChainDynParam dynamics;
  KDL::ChainIdSolver_RNE newton_euler;
  KDL::JntArray q;
  KDL::JntArrayVel qv;
  KDL::JntArray vector;
  KDL::Jacobian J;
  KDL::JntArray a;
  KDL::JntSpaceInertiaMatrix M;
  KDL::Wrenches no_wrench;
  int error = 0;  // the first KDL reported

  void note(int code) noexcept {
    if (error == 0) error = code;
  }
};

ArmModel::ArmModel(const KDL::Chain& chain, const double gravity[3],
                   const std::vector<double>& rotor_inertia)
    : size_(checked_size(chain, rotor_inertia.size())),
      rotor_inertia_(Eigen::Map<const Eigen::VectorXd>(rotor_inertia.data(), size_)),
      solvers_(std::make_unique<Solvers>(chain, KDL::Vector(gravity[0], gravity[1], gravity[2]))) {
  ArmTerms probe(size_);
  const VectorJ zero = VectorJ::Zero(size_);
  evaluate(zero, zero, &probe);
  inverse_dynamics(zero, zero, zero);
  // KDL's error codes come from sizes and structure alone: right here, right for ever.
  if (solvers_->error != KDL::SolverI::E_NOERROR) {
    throw ConfigError("the kinematic chain cannot be solved (KDL error " +
                      std::to_string(solvers_->error) + ")");
  }
}

ArmModel::ArmModel(const LoadedRobot& robot)
    : ArmModel(robot.chain, robot.robot.gravity, rotor_inertias(robot.robot)) {}

ArmModel::~ArmModel() = default;

void ArmModel::evaluate(const VectorJ& q, const VectorJ& v, ArmTerms* terms) noexcept {
  evaluate(q, v, TermsDue{}, terms);
}

void ArmModel::evaluate(const VectorJ& q, const VectorJ& v, const TermsDue& due,
                        ArmTerms* terms) noexcept {
  Solvers& s = *solvers_;
  terms->X_BT = tip_pose(q);
  if (due.jacobian) {
    terms->J = jacobian(q);
    s.qv.q.data = q;
    s.qv.qdot.data = v;
    KDL::Twist jdot_v;
    s.note(s.jacobian_rate.JntToJacDot(s.qv, jdot_v));
    terms->Jdot_v = six(jdot_v);
  }
  terms->V_BT.noalias() = terms->J * v;
  if (due.inertia) {
    terms->M = mass(q);
    terms->B = rotor_inertia_;
    terms->M_total = terms->M;
    terms->M_total.diagonal() += terms->B;
  }
  if (due.inertia || due.jacobian) {
    terms->Minv_JT = terms->J.transpose();
    terms->M_total.llt().solveInPlace(terms->Minv_JT);
  }
  if (due.coriolis) terms->Cv = coriolis(q, v);
  terms->g = gravity(q);
}

Pose ArmModel::tip_pose(const VectorJ& q) noexcept {
  Solvers& s = *solvers_;
  s.q.data = q;
  KDL::Frame frame;
  s.note(s.position.JntToCart(s.q, frame));
  return pose_of(frame);
}

Matrix6J ArmModel::jacobian(const VectorJ& q) noexcept {
  Solvers& s = *solvers_;
  s.q.data = q;
  s.note(s.jacobian.JntToJac(s.q, s.J));
  return s.J.data;
}

MatrixJ ArmModel::mass(const VectorJ& q) noexcept {
  Solvers& s = *solvers_;
  s.q.data = q;
  s.note(s.dynamics.JntToMass(s.q, s.M));
  return s.M.data;
}

VectorJ ArmModel::coriolis(const VectorJ& q, const VectorJ& v) noexcept {
  Solvers& s = *solvers_;
  s.q.data = q;
  s.qv.qdot.data = v;
  s.note(s.dynamics.JntToCoriolis(s.q, s.qv.qdot, s.vector));
  return s.vector.data;
}

VectorJ ArmModel::inverse_dynamics(const VectorJ& q, const VectorJ& v, const VectorJ& a) noexcept {
  Solvers& s = *solvers_;
  s.q.data = q;
  s.qv.qdot.data = v;
  s.a.data = a;
  s.note(s.newton_euler.CartToJnt(s.q, s.qv.qdot, s.a, s.no_wrench, s.vector));
  return s.vector.data + rotor_inertia_.cwiseProduct(a);
}

VectorJ ArmModel::gravity(const VectorJ& q) noexcept {
  Solvers& s = *solvers_;
  s.q.data = q;
  s.note(s.dynamics.JntToGravity(s.q, s.vector));
  return s.vector.data;
}

void ArmModel::evaluate_statics(const VectorJ& q, ArmTerms* terms) noexcept {
  terms->X_BT = tip_pose(q);
  terms->J = jacobian(q);
  terms->g = gravity(q);
}

}  // namespace limber::controller
