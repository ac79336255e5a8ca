// How true the reference integrator is: against KDL's inverse dynamics under Runge-Kutta steps that
// are twenty times shorter, which share neither algorithm nor code with it.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <numbers>

#include "robots/loader/load_robot.h"
#include "sim/plant/arm_plant.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_reference_truth {
namespace {

constexpr double kCycle_s = 1e-3;

KDL::JntArray to_kdl(const VectorJ& q) {
  KDL::JntArray out(static_cast<unsigned>(q.size()));
  out.data = q;
  return out;
}

/// (M + B) qdd = tau - C v - g, by KDL, with the torque held over a cycle.
class Truth {
 public:
  Truth(const LoadedRobot& robot, const VectorJ& q_start)
      : q(q_start),
        v(VectorJ::Zero(q_start.size())),
        chain_(robot.chain),
        gravity_(robot.robot.gravity[0], robot.robot.gravity[1], robot.robot.gravity[2]),
        terms_(chain_, gravity_),
        inverse_(chain_, gravity_),
        M_(chain_.getNrOfJoints()),
        bias_(chain_.getNrOfJoints()),
        no_wrench_(chain_.getNrOfSegments(), KDL::Wrench::Zero()),
        B_(q_start.size()) {
    for (int i = 0; i < B_.size(); ++i) B_[i] = robot.robot.joints[i].drive.rotor_inertia_kgm2;
  }

  VectorJ q, v;

  void cycle(const VectorJ& tau) {
    constexpr int kSteps = 20;
    constexpr double h = kCycle_s / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const VectorJ a1 = acceleration(q, v, tau), v2 = v + 0.5 * h * a1;
      const VectorJ a2 = acceleration(q + 0.5 * h * v, v2, tau), v3 = v + 0.5 * h * a2;
      const VectorJ a3 = acceleration(q + 0.5 * h * v2, v3, tau), v4 = v + h * a3;
      const VectorJ a4 = acceleration(q + h * v3, v4, tau);
      q += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
  }

 private:
  VectorJ acceleration(const VectorJ& at, const VectorJ& rate, const VectorJ& tau) {
    const KDL::JntArray position = to_kdl(at);
    EXPECT_EQ(terms_.JntToMass(position, M_), 0);
    EXPECT_EQ(inverse_.CartToJnt(position, to_kdl(rate), to_kdl(VectorJ::Zero(at.size())),
                                 no_wrench_, bias_),
              0);
    MatrixJ M = M_.data;
    M.diagonal() += B_;
    const VectorJ net = tau - bias_.data;
    return M.llt().solve(net);
  }

  KDL::Chain chain_;
  KDL::Vector gravity_;
  KDL::ChainDynParam terms_;
  KDL::ChainIdSolver_RNE inverse_;
  KDL::JntSpaceInertiaMatrix M_;
  KDL::JntArray bias_;
  KDL::Wrenches no_wrench_;
  VectorJ B_;
};

/// Largest difference of a joint position after so many cycles of the openarm, its end stops out of
/// the way; each of the two gets the torque that its own state asks for.
template <typename Torque>
double difference(int cycles, double step, const Torque& torque) {
  LoadedRobot robot = load_robot("openarm");
  VectorJ home(robot.robot.size());
  for (int i = 0; i < robot.robot.size(); ++i) {
    JointConfig& joint = robot.robot.joints[i];
    home[i] = joint.home;
    joint.position_min = -1e9;
    joint.position_max = 1e9;
  }
  Truth truth(robot, home);
  ForceModel forces(robot.robot, false);
  const auto plant = make_arm_plant(Integrator::kReference, build_arm_model(robot));
  plant->set_state(home, VectorJ::Zero(home.size()));
  for (int k = 0; k < cycles; ++k) {
    const double t = k * kCycle_s;
    const VectorJ tau = torque(robot.robot, t, plant->q() - home, plant->v());
    for (int i = 0; i < tau.size(); ++i) {
      forces.drives[i].tau_ff = tau[i];
      forces.drives[i].limit = 1e3;
    }
    for (int s = 0; s < std::lround(kCycle_s / step); ++s) plant->step(&forces, step, 0);
    truth.cycle(torque(robot.robot, t, truth.q - home, truth.v));
  }
  return (plant->q() - truth.q).cwiseAbs().maxCoeff();
}

TEST(ReferenceTruth, HeldAlongASine) {
  const auto impedance = [](const Robot& robot, double t, const VectorJ& moved, const VectorJ& v) {
    const double phase = std::numbers::pi * t;
    VectorJ tau(robot.size());
    for (int i = 0; i < robot.size(); ++i) {
      const DriveConfig& drive = robot.joints[i].drive;
      tau[i] = drive.hold_kp_Nm_per_rad * (0.1 * (1.0 - std::cos(phase)) - moved[i]) +
               drive.hold_kd_Nms_per_rad * (0.1 * std::numbers::pi * std::sin(phase) - v[i]);
    }
    return tau;
  };
  EXPECT_LT(difference(400, 1e-3, impedance), 1e-9);
}

TEST(ReferenceTruth, HalfASecondOfFall) {
  const auto none = [](const Robot& robot, double, const VectorJ&, const VectorJ&) {
    return VectorJ(VectorJ::Zero(robot.size()));
  };
  EXPECT_LT(difference(500, 1e-3, none), 1e-6);
}

}  // namespace
}  // namespace limber::sim::test_reference_truth
