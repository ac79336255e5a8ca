// The arm as something that moves: one interface, two integrators.
//
// - reference: reduced coordinates, Runge-Kutta 4; exact enough to
//   compare formulas with.
// - ode: maximal coordinates, one ODE body a link, dWorldStep; first order, as the physics engines
//   users know.
//
// At the default step of 0.25 ms ode is within 1e-5 rad of the reference while a 7-joint arm tracks
// a sine (3.4e-5 rad at 1 ms), a fortieth of a count of a 14-bit encoder. Joint springs do not make
// it worse: at 1 rad/s 2e-4 rad with or without, and 1e-10 rad for the reference.
#pragma once

#include <cstdint>
#include <memory>

#include "scenarios/loader/scenario.h"
#include "sim/model/link_dynamics.h"
#include "sim/plant/arm_state.h"
#include "sim/plant/force_model.h"

namespace limber::sim {

/// After construction every member is free of allocation, locks, logs and exceptions.
class ArmPlant {
 public:
  virtual ~ArmPlant() = default;
  ArmPlant(const ArmPlant&) = delete;
  ArmPlant& operator=(const ArmPlant&) = delete;

  /// Motors behind springs go where the springs are relaxed.
  void set_state(const VectorJ& q, const VectorJ& v) noexcept;
  void set_state(const ArmState& x) noexcept;
  /// Advances by h seconds from simulated time t. A step that would end in a state that is not
  /// finite or faster than kMaxSpeed is not taken: the arm stops where it was, and diverged()
  /// counts.
  void step(ForceModel* forces, double h, std::int64_t t_ns) noexcept;
  /// A point mass at the tip, kg, at p_TL in tip axes, m; 0 removes it. Velocities stay, momentum
  /// does not.
  void set_payload(double mass, const Eigen::Vector3d& p_TL) noexcept;

  /// Joint torque of wall and pushes at the present state and simulated time t.
  const VectorJ& external_torque(const Environment& environment, std::int64_t t_ns) noexcept;

  const ArmState& state() const noexcept { return x_; }
  const VectorJ& q() const noexcept { return x_.q; }
  const VectorJ& v() const noexcept { return x_.v; }
  /// Kinematics and energies of the links (with rotors that are part of them).
  const LinkDynamics& arm() const noexcept { return arm_; }
  /// Of links and all rotors, J.
  double kinetic_energy() const noexcept;
  /// Since construction.
  const Work& work() const noexcept { return work_; }
  std::int64_t diverged() const noexcept { return diverged_; }

  static constexpr double kMaxSpeed = 1e3;  ///< rad/s or m/s

 protected:
  explicit ArmPlant(const ArmModel& model);

  /// Moves x_, work_ and arm_ on by one step; forces->begin_step() has been done and arm_ is at x_.
  virtual void integrate(ForceModel* forces, double h) noexcept = 0;
  /// Into how many equal parts a step is to be cut to be stable.
  virtual int parts(const ForceModel&, double) const noexcept { return 1; }
  /// Takes over x_ after it has been set from outside.
  virtual void state_was_set() noexcept {}
  /// Takes over the tip body's new mass properties; arm_ is at x_.
  virtual void payload_was_set() noexcept {}
  /// Motors of rigid joints go where their links are.
  void carry_rotors() noexcept;
  const std::vector<MotorModel>& motors() const noexcept { return arm_.model().motors; }

  LinkDynamics arm_;
  ArmState x_;
  Work work_;

 private:
  std::int64_t diverged_ = 0;
};

/// Throws ConfigError when the integrator cannot take this arm (massless links in ODE; a joint that
/// moves no mass at all; a motor behind a spring without rotor inertia).
std::unique_ptr<ArmPlant> make_arm_plant(Integrator integrator, const ArmModel& model);

}  // namespace limber::sim
