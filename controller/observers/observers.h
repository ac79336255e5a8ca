// The observers of the cycle: velocities, contact, tip acceleration, friction. Which of them run is
// a matter of LawSettings.
#pragma once

#include <limber/joint_state_t.hpp>
#include <optional>

#include "controller/impedance/nullspace.h"
#include "controller/kinds/estimates.h"
#include "controller/kinds/goal.h"
#include "controller/kinds/law_entry.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"
#include "controller/observers/alpha_beta.h"
#include "controller/observers/dither.h"
#include "controller/observers/filtered_difference.h"
#include "controller/observers/friction_feedforward.h"
#include "controller/observers/friction_observer.h"
#include "controller/observers/levant.h"
#include "controller/observers/momentum_observer.h"
#include "controller/observers/tip_force.h"

namespace limber::controller {

class Observers {
 public:
  explicit Observers(const LoadedRobot& robot);

  /// Takes new settings. A new velocity estimator goes on from the velocity there is, so that no
  /// torque jumps; contact observers that change start over. In the cycle.
  void set(const LawSettings& settings) noexcept;
  /// The next state does not follow on the last one: all observers start over. In the cycle.
  void restart() noexcept;

  /// Puts the chosen estimate in the place of the drives' velocities, on arms with elastic joints
  /// those of the motors, where damping acts. In the cycle, before the terms are evaluated.
  void estimate_velocity(ArmState* state) noexcept;
  /// Contact and tip acceleration, from the terms at this state. In the cycle.
  void observe(const ArmState& state, const ArmTerms& terms, const TaskRows& rows) noexcept;
  /// Torque of this cycle that compensates the gear's friction, N m, at the velocity that the goal
  /// wants of a law of this type; v: present joint velocity, n. Once a cycle, in the cycle.
  VectorJ friction(const Goal& goal, GoalType type, const VectorJ& v,
                   const ArmTerms& terms) noexcept;

  const Estimates& estimates() const noexcept { return estimates_; }

 private:
  void make_velocity_estimators() noexcept;
  void make_contact_observers() noexcept;
  void make_friction_observer() noexcept;
  void set_period(double T) noexcept;
  void observe_friction(const ArmState& state) noexcept;
  void observe_joint_torque(const ArmState& state, const ArmTerms& terms,
                            const TaskRows& rows) noexcept;

  int joints_;
  bool elastic_;         // some joint has a spring
  bool torque_sensors_;  // at every joint
  double T_;             // s
  VectorJ q_;            // of the state before, where velocity is estimated
  VectorJ v_;
  bool started_ = false;
  double position_noise_;  // rad
  LawSettings settings_ = default_settings();
  FrictionFeedforward friction_;
  Dither dither_;
  FilteredDifference<VectorJ> filtered_difference_;
  AlphaBeta alpha_beta_;
  LevantDifferentiator levant_;
  MomentumObserver momentum_;
  std::optional<FrictionObserver> friction_observer_;
  TipAcceleration tip_acceleration_;
  VectorJ rotor_inertia_;
  std::optional<TipForce> tip_force_;
  Estimates estimates_;
};

}  // namespace limber::controller
