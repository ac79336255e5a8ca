// From measured state to torque: the terms, the law that runs, and everything around it.
#pragma once

#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/controller_status_t.hpp>
#include <limber/joint_state_t.hpp>
#include <memory>
#include <vector>

#include "controller/arm_side.h"
#include "controller/arm_state.h"
#include "controller/arm_terms.h"
#include "controller/energy_tank.h"
#include "controller/estimation.h"
#include "controller/gains.h"
#include "controller/goal_generator.h"
#include "controller/inverse_kinematics.h"
#include "controller/laws/registry.h"
#include "controller/limits.h"
#include "controller/nullspace.h"
#include "controller/observers/passivity_observer.h"
#include "controller/preload_servo.h"
#include "controller/torque_blend.h"

namespace limber::controller {

/// Does as it is told and knows no modes. After construction no member allocates, locks, logs or
/// throws; all may be called in the cycle.
class TorqueCycle {
 public:
  /// Makes all laws this arm can run. Throws ConfigError.
  TorqueCycle(const LoadedRobot& robot, const std::string& law);

  /// The state of this cycle, judged usable, and the terms that follow from it.
  void measure(const joint_state_t& message) noexcept;
  /// The next state does not follow on the last one: nothing estimated from the past is left.
  void restart() noexcept { estimation_.restart(); }

  /// Runs joint_pd, or the selected law, around the place where the arm is. The torque
  /// continues from the last one and fades over to the law (TorqueBlend).
  /// Holding knows no choices of the user's, only K_q (as far as the springs of elastic joints
  /// allow) and its damping ratio: it carries the weight and damps, whatever was tried before, and
  /// brings the preload of two motors to robot.yaml's.
  void hold() noexcept {
    holding_ = true;
    run(hold_, true);
  }
  void activate() noexcept {
    holding_ = false;
    run(selected_, true);
  }
  /// The goal comes to rest.
  void stop_goal(double duration_s) noexcept { goals_.stop(duration_s); }

  /// nullptr: accepted, else why not. `active`: the selected law is the one that runs.
  const char* set_goal(const compliance_goal_t& message) noexcept;
  const char* set_gains(const compliance_gains_t& message, bool active) noexcept;

  /// One cycle of the running law, `dt_s` after the last. False if the result is not finite; the
  /// torque is then the one before.
  bool control(double dt_s) noexcept;
  /// One cycle without a law, the goal where the arm is: straight to `target`, or in steps the gate
  /// lets pass if `in_steps`.
  void rest(const VectorJ& target, bool in_steps, PreloadAtRest preload) noexcept;

  const VectorJ& torque() const noexcept { return limits_.previous(); }
  /// Of two motors the sum of their torques, n; zero for joints with one.
  const VectorJ& preload_torque() const noexcept { return preload_.torque(); }
  const VectorJ& tau_applied() const noexcept { return state_.tau_applied; }
  /// The model's gravity torque, within the joints' limits; the last finite one.
  const VectorJ& gravity() const noexcept { return gravity_; }

  /// Everything in the status that follows from state, law and torque.
  void describe(controller_status_t* status) noexcept;

 private:
  void run(int law, bool from_here) noexcept;
  bool due(Term term) const noexcept;
  Position position() const noexcept;
  void look(StaticForm form) noexcept;
  void match_goals() noexcept;
  const char* refuse_stiffness(const LawEntry& wanted) const noexcept;
  void refresh_gains() noexcept;
  void keep_within_springs() noexcept;
  void draw_from_tank() noexcept;
  void keep_passive() noexcept;
  void forget_energy() noexcept;
  VectorJ friction() const noexcept;
  VectorJ null_space() noexcept;
  void describe_tip(controller_status_t* status) const noexcept;
  void describe_parts(controller_status_t* status) const noexcept;
  LawInputs inputs(double dt_s) const noexcept;
  const LawEntry& entry() const noexcept { return laws()[static_cast<std::size_t>(running_)]; }

  ArmModel model_;
  ArmState state_;  // as measured
  ArmState seen_;   // on the side the law looks at; the terms are evaluated there
  ArmTerms terms_;
  unsigned sensors_;
  ArmSide side_;
  std::vector<std::unique_ptr<Law>> laws_;  // by registry index; empty where the arm lacks a sensor
  int hold_;
  int selected_;
  int running_;
  bool holding_ = true;
  bool resting_ = true;
  bool solved_ = true;
  bool softened_ = false;  // K_x, to what the springs allow

  GoalGenerator goals_;
  Goal goal_;  // of this cycle: tip and joints matched
  InverseKinematics inverse_kinematics_;
  GainRamp gains_;
  Gains active_;  // of this cycle, in base axes
  Gains asked_;   // where a gains message is read into
  Estimation estimation_;
  EnergyTank tank_;
  PassivityObserver<Eigen::Vector3d> passivity_;
  Eigen::Vector3d F_on_its_way_ = Eigen::Vector3d::Zero();
  double dissipated_W_ = 0.0;  // by the law's damper in the cycle before
  TaskRows rows_;
  std::int64_t cycles_ = 0;
  TorqueBlend blend_;
  bool switched_ = false;
  JointLimits limits_;
  PreloadServo preload_;
  VectorJ null_limit_;
  VectorJ none_;

  LawOutput law_;
  VectorJ tau_null_;
  VectorJ tau_gravity_;
  VectorJ tau_coriolis_;
  VectorJ tau_friction_;
  VectorJ gravity_;
  std::int32_t limits_active_ = 0;
};

}  // namespace limber::controller
