// Arms to try the controller on, built in code, and their motion.
#pragma once

#include <random>

#include "controller/model/arm_terms.h"
#include "robots/loader/load_robot.h"

namespace limber::testing {

/// Lengths, masses, inertias of the planar arm whose closed form is in every textbook (rods in x-y,
/// axes along z, gravity along -y). motor_mass sits at the elbow.
struct PlanarParameters {
  double a1, a2, l1, l2, m1, m2, I1, I2, kr1, kr2, motor_mass, Im1, Im2;
};
inline constexpr PlanarParameters kTextbook{1.0,  1.0,   0.5,   0.5, 50.0, 50.0, 10.0,
                                            10.0, 100.0, 100.0, 5.0, 0.01, 0.01};
inline constexpr PlanarParameters kDesktop{0.35,  0.3,  0.175, 0.15, 1.2,    0.8,   0.01225,
                                           0.006, 10.0, 10.0,  0.3,  1.8e-5, 1.8e-5};

LoadedRobot planar_arm(const PlanarParameters& parameters);

/// A mass on a rail along x without gravity: one prismatic joint, kSliderMass with the rotor's.
LoadedRobot slider();
inline constexpr double kSliderMass = 2.0;

/// Seven joints like a human arm's, all axes different, no symmetric inertia.
LoadedRobot seven_joint_arm();

/// The same with series elastic joints: springs and rotors of about Baxter's size, link encoders
/// and torque sensors if `sensors`.
LoadedRobot elastic_arm(bool sensors);
/// The same with two motors and quadratic springs at every joint, all sensors.
LoadedRobot antagonistic_arm();
/// Any arm: revolute and prismatic joints about random axes with fixed and massless segments
/// between, tilted base, gravity in no particular direction.
LoadedRobot random_arm(int joints, unsigned seed, bool prismatic);

/// Fills in what robot.yaml would say: wide limits, gains, small rotors.
LoadedRobot with_drives(const KDL::Chain& chain, const Eigen::Vector3d& gravity);

VectorJ random_vector(int n, double size, std::mt19937& generator);
Vector6 random_six(double size, std::mt19937& generator);
/// Symmetric positive definite, eigenvalues about `linear` and `angular`, all entries used.
Matrix6 random_stiffness(double linear, double angular, std::mt19937& generator);

/// The rigid arm itself: (M + B) a = tau - C v - g + J^T F_ext, classic Runge-Kutta 4.
class Plant {
 public:
  explicit Plant(const LoadedRobot& robot);

  /// `torque(q, v)` is evaluated at every stage: continuous-time control.
  template <typename Torque>
  void advance(double dt, Torque torque);
  VectorJ acceleration(const VectorJ& q_at, const VectorJ& v_at, const VectorJ& tau);
  double kinetic_energy();
  /// Gravity's potential along the motion is not needed: laws compensate it.

  VectorJ q;
  VectorJ v;
  Vector6 F_ext = Vector6::Zero();
  controller::ArmModel model;
  controller::ArmTerms terms;
};

template <typename Torque>
void Plant::advance(double dt, Torque torque) {
  const auto rate = [&](const VectorJ& q_at, const VectorJ& v_at) {
    return acceleration(q_at, v_at, torque(q_at, v_at));
  };
  const VectorJ a1 = rate(q, v);
  const VectorJ v2 = v + 0.5 * dt * a1;
  const VectorJ a2 = rate(q + 0.5 * dt * v, v2);
  const VectorJ v3 = v + 0.5 * dt * a2;
  const VectorJ a3 = rate(q + 0.5 * dt * v2, v3);
  const VectorJ v4 = v + dt * a3;
  const VectorJ a4 = rate(q + dt * v3, v4);
  q += dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
  v += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
}

}  // namespace limber::testing
