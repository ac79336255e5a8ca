// What every control law is. A law is one file in this folder and one line in registry.cc.
//
// The file defines `LawEntry NAME_law()` (see the end of this header), the parameters that belong
// to the law alone, and a class derived from Law that nobody else includes. The cycle composes
//
//   tau = law + [null space] + [gravity] + [Coriolis] + friction      (what the entry wants)
//
// and then blends, limits and sends it; a law does none of that.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/types.h"
#include "controller/elastic/joint_elasticity.h"
#include "controller/gains/gains.h"
#include "controller/goals/goal.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"
#include "robots/loader/load_robot.h"

namespace limber::controller {

/// What a law may need of an arm, to be combined with |.
namespace sensors {
inline constexpr unsigned kLinkEncoder = 1;   ///< q, v: on a rigid joint the motor's encoder does
inline constexpr unsigned kMotorEncoder = 2;  ///< theta, theta_dot
inline constexpr unsigned kTorqueSensor = 4;  ///< tau_measured from a sensor, not from the current
inline constexpr unsigned kTipForceSensor = 8;
inline constexpr unsigned kElasticJoints = 16;  ///< a spring between motor and link everywhere
inline constexpr unsigned kTwoMotors = 32;      ///< that pull against each other, everywhere
inline constexpr unsigned kDeflection = 64;  ///< of the springs, by link encoder or torque sensor
inline constexpr unsigned kSprings = 128;    ///< some joint is not rigid
}  // namespace sensors

/// The goal that a law follows. Laws for the joints take goals at the tip too: the cycle solves the
/// inverse kinematics.
enum class GoalType : std::uint8_t {
  kNone,
  kPose,
  kJoints,           ///< no feed-forward wrench
  kJointsAndWrench,  ///< and adds Goal::F_ff
  kSmoothJoints,     ///< no wrench; from rest along SmoothMotion
};

inline bool follows_joints(GoalType type) noexcept {
  return type == GoalType::kJoints || type == GoalType::kJointsAndWrench ||
         type == GoalType::kSmoothJoints;
}

/// The potential whose gradient a law's torque at rest is, as a function of the link's position:
/// what it takes to evaluate the law at q_bar (PositionFeedback::kStatic, see qbar.h).
enum class Potential : std::uint8_t {
  kNone,         ///< its torque at rest is no gradient, or not one that q_bar is solved for
  kGravity,      ///< the weight alone: carried, or what the springs bend under
  kJointSpring,  ///< and -K_q (q - q_d)
  kTipSpring,    ///< and J^T (F_ff - h A^T K_x e)
};

/// Which spring's designed damping reckons with springs in the joints (elastic_design.h).
enum class DampedAt : std::uint8_t { kNothing, kJoints, kTip };

/// Estimates of this instant; zero where LawSettings::contact names no source.
struct Estimates {
  explicit Estimates(int joints) : tau_ext(VectorJ::Zero(joints)) {}

  VectorJ tau_ext;                  ///< torque of the world on the joints, N m
  Vector6 F_ext = Vector6::Zero();  ///< wrench of the world on the tip, base axes, N and N m
  Vector6 A_BT = Vector6::Zero();   ///< dV_BT/dt, filtered, m/s^2 and rad/s^2
};

/// What the cycle adds to the law's torque.
struct Compensation {
  bool gravity = true;      ///< + g
  bool coriolis = false;    ///< + C v
  bool null_space = false;  ///< + N (-K_null (q - q_null) - D_null v)
};

/// The compensation with the user's choice of the model terms.
inline Compensation chosen_compensation(Compensation of_law, ModelCompensation choice) noexcept {
  if (choice == ModelCompensation::kLawDefault) return of_law;
  of_law.gravity = choice != ModelCompensation::kNone;
  of_law.coriolis = choice == ModelCompensation::kGravityCoriolis;
  return of_law;
}

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

/// A quantity that a law reports besides its torque, in controller_status_t::law_outputs.
struct LawReport {
  const char* key;
  const char* unit;
  const char* meaning;
  bool per_joint = false;
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

/// One line of the registry.
struct LawEntry {
  const char* name;
  const char* summary;  ///< one line for --list-laws, with the lecture's equation if it has one
  unsigned needs;       ///< sensors::*
  GoalType goal_type;
  Compensation compensation;
  Potential potential = Potential::kNone;
  DampedAt damped = DampedAt::kNothing;
  /// Shows a mistake found in print; refused unless every bus is simulated.
  bool demonstration = false;
  /// Numbers of this law alone; rows at namespace scope in its file.
  std::vector<GainRow*> parameters = {};
  std::vector<LawReport> reports = {};
  /// Makes the law for an arm that has what it needs. May throw ConfigError.
  std::unique_ptr<Law> (*make)(const LoadedRobot& robot) = nullptr;
};

}  // namespace limber::controller
