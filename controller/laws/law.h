// What every control law is. A law is one file in this folder and one line in registry.cc.
//
// The file defines `LawEntry NAME_law()` (kinds/law_entry.h), the parameters that belong
// to the law alone, and a class derived from Law that nobody else includes. The cycle composes
//
//   tau = law + [null space] + [gravity] + [Coriolis] + friction      (what the entry wants)
//
// and then blends, limits and sends it; a law does none of that.
#pragma once

#include <cstdint>

#include "common/types.h"
#include "controller/elastic/joint_elasticity.h"
#include "controller/kinds/estimates.h"
#include "controller/kinds/gains.h"
#include "controller/kinds/goal.h"
#include "controller/kinds/law_entry.h"
#include "controller/kinds/sensors.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"

namespace limber::controller {

/// Everything a law receives, of the same instant. The references outlive the call only.
struct LawInputs {
  const ControlPoint& point;  ///< position and velocity for springs and dampers
  const ArmState& state;      ///< both sides of the joints, torques, preload; velocities estimated
  const ArmTerms& terms;      ///< of the model, at `point`
  const Goal& goal;           ///< after interpolation
  const Gains& gains;         ///< after ramps, in base axes
  const Estimates& estimates;
  const JointElasticity* elastic = nullptr;  ///< springs of the joints; nullptr: all are rigid
  double dt_s = 0.0;                         ///< since the law's last cycle
  bool stiffness_due = true;                 ///< what a law derives from K_x, it may derive anew
  bool damping_due = true;                   ///< the same for damping
};

/// The law's torque by parts, N m, n each; their sum is what counts.
struct LawOutput {
  explicit LawOutput(int joints)
      : tau_stiffness(VectorJ::Zero(joints)),
        tau_damping(VectorJ::Zero(joints)),
        tau_feedforward(VectorJ::Zero(joints)) {}

  void reset() noexcept {
    tau_stiffness.setZero();
    tau_damping.setZero();
    tau_feedforward.setZero();
    F.setZero();
    F_other.setZero();
    spring_energy_J = 0.0;
    limits = 0;
  }
  /// A law at the tip: its wrench by parts, and the joint torques they take.
  void act_at_tip(const Matrix6J& J, const Vector6& F_spring, const Vector6& F_damping,
                  const Vector6& F_rest) noexcept {
    F = F_spring + F_damping + F_rest;
    F_other = F_rest;
    tau_stiffness = J.transpose() * F_spring;
    tau_damping = J.transpose() * F_damping;
    tau_feedforward = J.transpose() * F_rest;
  }
  VectorJ tau() const noexcept { return tau_stiffness + tau_damping + tau_feedforward; }

  VectorJ tau_stiffness;
  VectorJ tau_damping;
  VectorJ tau_feedforward;
  Vector6 F = Vector6::Zero();  ///< wrench on the arm at the tip, base axes; zero if it has none
  Vector6 F_other = Vector6::Zero();  ///< what of it is neither spring nor damper
  double spring_energy_J = 0.0;       ///< potential whose gradient tau_stiffness is, if it is one
  std::int32_t limits = 0;            ///< controller_status_t LIMIT_* bits
};

class Law {
 public:
  virtual ~Law() = default;
  /// nullptr, or why the law cannot work with these gains on this arm. May be called in the cycle.
  virtual const char* check(const Gains& gains) const noexcept {
    static_cast<void>(gains);
    return nullptr;
  }
  /// The law becomes the running one: forget the past. In the cycle.
  virtual void start(const LawInputs& inputs) noexcept { static_cast<void>(inputs); }
  /// One cycle; `output` has been reset. No allocation, lock, log or exception.
  virtual void compute(const LawInputs& inputs, LawOutput* output) noexcept = 0;
  /// Preload wanted of joints with two motors, n, rad; nullptr: robot.yaml's. In the cycle.
  virtual const VectorJ* preload() const noexcept { return nullptr; }
  /// Writes the values of LawEntry::reports, in their order, to at most 24 places; a joint quantity
  /// takes one place a joint. In the cycle.
  virtual void report(float* values) const noexcept { static_cast<void>(values); }
};

}  // namespace limber::controller
