// The arm's terms, and the terms with a Cartesian impedance on top, beside KDL and Pinocchio, for 1
// to 16 joints: the openarm's seven, cut off or repeated. All agree to 1e-12, or the benchmark says
// that they do not.
#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "controller/impedance/nullspace.h"
#include "controller/model/arm_terms.h"
#include "controller/model/pose_error.h"
#include "robots/loader/load_robot.h"
#ifdef LIMBER_PINOCCHIO
#include "qa/bench/pinocchio_peer.h"
#endif

namespace {

using namespace limber;
using controller::ArmModel;
using controller::ArmTerms;
using controller::Pose;

constexpr double kGravity[3] = {0.0, 0.0, -9.81};
constexpr double kAgreement = 1e-10;  // of the torque, relative; the tip's inertia costs digits
constexpr double kLostShare = 1e-12;  // no direction of these states is lost: all compute the same

KDL::Chain chain_of(int joints) {
  static const KDL::Chain openarm = load_robot("openarm").chain;
  KDL::Chain chain;
  while (true) {
    for (const KDL::Segment& segment : openarm.segments) {
      const bool moves = segment.getJoint().getType() != KDL::Joint::Fixed;
      if (moves && static_cast<int>(chain.getNrOfJoints()) == joints) return chain;
      chain.addSegment(segment);
    }
  }
}

/// States and gains of every competitor; another state each time, as in a cycle.
struct Problem {
  explicit Problem(int joints) : n(joints), chain(chain_of(joints)) {
    std::srand(1);
    for (int i = 0; i < kStates; ++i) {
      q.emplace_back(VectorJ::Random(n));
      v.emplace_back(VectorJ::Random(n));
    }
    B.assign(static_cast<std::size_t>(n), 0.05);
    K << Eigen::Vector3d::Constant(500.0), Eigen::Vector3d::Constant(30.0);
    D << Eigen::Vector3d::Constant(40.0), Eigen::Vector3d::Constant(2.0);
  }
  static constexpr int kStates = 64;
  int n;
  KDL::Chain chain;
  std::vector<double> B;
  std::vector<VectorJ> q, v;
  Pose X_BD;
  Vector6 K, D;
};

/// What an impedance makes of a pose error and a twist.
Vector6 wrench(const Problem& problem, const Pose& X_BT, const Vector6& V_BT) {
  const auto error = controller::pose_error(X_BT, problem.X_BD, controller::Orientation::kLog);
  return -error.A.transpose() * problem.K.cwiseProduct(error.e) - problem.D.cwiseProduct(V_BT);
}

class Ours {
 public:
  explicit Ours(const Problem& problem)
      : problem_(problem), model_(problem.chain, kGravity, problem.B), terms_(problem.n) {}

  void terms(int i) {
    model_.evaluate(problem_.q[at(i)], problem_.v[at(i)], {.tip_inertia = false}, &terms_);
  }

  VectorJ torque(int i) {
    model_.evaluate(problem_.q[at(i)], problem_.v[at(i)], &terms_);
    const VectorJ tau_0 = -problem_.q[at(i)] - problem_.v[at(i)];
    const Matrix6 inertia = controller::damped_tip_inertia(terms_.tip, kLostShare);
    const Vector6 F = wrench(problem_, terms_.X_BT, terms_.V_BT) - inertia * terms_.Jdot_v -
                      inertia * (terms_.Minv_JT.transpose() * tau_0);
    return terms_.J.transpose() * F + tau_0 + terms_.Cv + terms_.g;
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i % Problem::kStates); }
  const Problem& problem_;
  ArmModel model_;
  ArmTerms terms_;
};

/// What a peer's terms need besides: the same torque, in Eigen's plainest way.
struct Tail {
  explicit Tail(int n) : M(n, n), Minv_JT(n, 6) {}
  VectorJ torque(const Problem& problem, std::size_t k, const Pose& X_BT, const Matrix6J& J,
                 const Vector6& Jdot_v, const VectorJ& bias) {
    for (int i = 0; i < problem.n; ++i) M(i, i) += problem.B[static_cast<std::size_t>(i)];
    Minv_JT = J.transpose();
    M.selfadjointView<Eigen::Upper>().llt().solveInPlace(Minv_JT);
    const VectorJ tau_0 = -problem.q[k] - problem.v[k];
    const Matrix6 G = J * Minv_JT;
    const Vector6 right = Jdot_v + Minv_JT.transpose() * tau_0;
    const Vector6 F = wrench(problem, X_BT, J * problem.v[k]) - G.llt().solve(right);
    return J.transpose() * F + tau_0 + bias;
  }
  MatrixJ M;
  MatrixJ6 Minv_JT;
};

class Kdl {
 public:
  explicit Kdl(const Problem& problem)
      : problem_(problem),
        chain_(problem.chain),
        position_(chain_),
        jacobian_(chain_),
        jacobian_rate_(chain_),
        dynamics_(chain_, KDL::Vector(kGravity[0], kGravity[1], kGravity[2])),
        qv_(chain_.getNrOfJoints()),
        J_(chain_.getNrOfJoints()),
        M_(chain_.getNrOfJoints()),
        Cv_(chain_.getNrOfJoints()),
        g_(chain_.getNrOfJoints()),
        tail_(problem.n) {}

  void terms(int i) {
    qv_.q.data = problem_.q[at(i)];
    qv_.qdot.data = problem_.v[at(i)];
    position_.JntToCart(qv_.q, X_);
    jacobian_.JntToJac(qv_.q, J_);
    jacobian_rate_.JntToJacDot(qv_, rate_);
    dynamics_.JntToMass(qv_.q, M_);
    dynamics_.JntToCoriolis(qv_.q, qv_.qdot, Cv_);
    dynamics_.JntToGravity(qv_.q, g_);
  }

  VectorJ torque(int i) {
    terms(i);
    Pose X;
    X.p << X_.p.x(), X_.p.y(), X_.p.z();
    X_.M.GetQuaternion(X.Q.x(), X.Q.y(), X.Q.z(), X.Q.w());
    Vector6 Jdot_v;
    for (int k = 0; k < 6; ++k) Jdot_v[k] = rate_[k];
    tail_.M = M_.data;
    return tail_.torque(problem_, at(i), X, J_.data, Jdot_v, Cv_.data + g_.data);
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i % Problem::kStates); }
  const Problem& problem_;
  KDL::Chain chain_;
  KDL::ChainFkSolverPos_recursive position_;
  KDL::ChainJntToJacSolver jacobian_;
  KDL::ChainJntToJacDotSolver jacobian_rate_;
  KDL::ChainDynParam dynamics_;
  KDL::JntArrayVel qv_;
  KDL::Frame X_;
  KDL::Twist rate_;
  KDL::Jacobian J_;
  KDL::JntSpaceInertiaMatrix M_;
  KDL::JntArray Cv_, g_;
  Tail tail_;
};

#ifdef LIMBER_PINOCCHIO
class Pinocchio {
 public:
  explicit Pinocchio(const Problem& problem)
      : problem_(problem),
        peer_(dynamics::body_chain(problem.chain, problem.n), Eigen::Vector3d(kGravity)),
        tail_(problem.n) {}

  void terms(int i) {
    q_ = problem_.q[at(i)];
    v_ = problem_.v[at(i)];
    peer_.evaluate(q_, v_);
  }

  VectorJ torque(int i) {
    terms(i);
    tail_.M = peer_.M();
    return tail_.torque(problem_, at(i), {peer_.p, Eigen::Quaterniond(peer_.R)}, peer_.J,
                        peer_.Jdot_v, peer_.nle());
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i % Problem::kStates); }
  const Problem& problem_;
  bench::PinocchioPeer peer_;
  Eigen::VectorXd q_, v_;
  Tail tail_;
};
#endif

template <typename Competitor>
void terms(benchmark::State& run) {
  const Problem problem(static_cast<int>(run.range(0)));
  Competitor competitor(problem);
  int i = 0;
  for (auto _ : run) {
    competitor.terms(++i);
    benchmark::ClobberMemory();
  }
}

template <typename Competitor>
void impedance(benchmark::State& run) {
  const Problem problem(static_cast<int>(run.range(0)));
  Competitor competitor(problem);
  Ours ours(problem);
  for (int i = 0; i < Problem::kStates; ++i) {
    const VectorJ expected = ours.torque(i);
    if (!((competitor.torque(i) - expected).norm() <= kAgreement * (1.0 + expected.norm())))
      run.SkipWithError("the torques differ");
  }
  int i = 0;
  for (auto _ : run) benchmark::DoNotOptimize(competitor.torque(++i));
}

// With fewer than seven joints some of the states are too near to singular to agree.
BENCHMARK(terms<Ours>)->Name("terms/limber")->DenseRange(1, 16);
BENCHMARK(terms<Kdl>)->Name("terms/kdl")->DenseRange(1, 16);
BENCHMARK(impedance<Ours>)->Name("impedance/limber")->DenseRange(7, 16);
BENCHMARK(impedance<Kdl>)->Name("impedance/kdl")->DenseRange(7, 16);
#ifdef LIMBER_PINOCCHIO
BENCHMARK(terms<Pinocchio>)->Name("terms/pinocchio")->DenseRange(1, 16);
BENCHMARK(impedance<Pinocchio>)->Name("impedance/pinocchio")->DenseRange(7, 16);
#endif

}  // namespace
