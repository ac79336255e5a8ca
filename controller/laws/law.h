// What every control law is. A law is one file in this folder and one line in registry.cc.
//
// The file defines `LawEntry NAME_law()` (see the end of this header) and a class derived from Law
// that nobody else sees. The cycle composes the torque:
//
//   tau = law + [null space] + [gravity] + [Coriolis]            (what the entry asks for)
//
// and then blends, limits and sends it; a law does none of that.
#pragma once

#include <cstdint>
#include <memory>

#include "common/types.h"
#include "controller/arm_state.h"
#include "controller/arm_terms.h"
#include "controller/gains.h"
#include "controller/goal.h"
#include "robots/load_robot.h"

namespace limber::controller {

/// What a law may ask of an arm, to be combined with |.
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

/// Laws for the joints take goals at the tip too: the cycle solves the inverse kinematics.
enum class Follows : std::uint8_t {
  kNothing,
  kPoseGoal,
  kJointGoal,           ///< and exerts no wrench besides
  kJointGoalAndWrench,  ///< and adds Goal::F_ff
  kSmoothJointGoal,     ///< no wrench; from rest along SmoothMotion
};

inline bool follows_joints(Follows follows) noexcept {
  return follows == Follows::kJointGoal || follows == Follows::kJointGoalAndWrench ||
         follows == Follows::kSmoothJointGoal;
}

/// What a law asks of the link at rest, as a function of the link's position: what it needs to be
/// evaluated at q_bar (Position::kStatic, see qbar.h). Only laws whose torque at rest is the
/// gradient of a potential have one.
enum class StaticForm : std::uint8_t {
  kNone,
  kGravity,  ///< carries the weight; or sees the link where the weight alone bends the springs to
  kJointSpring,  ///< and -K_q (q - q_d)
  kTipSpring,    ///< and J^T (F_ff - h A^T K_x e)
};

/// What the observers say of this instant; zero where LawSettings::contact names no source.
struct Estimates {
  explicit Estimates(int joints) : tau_ext(VectorJ::Zero(joints)) {}

  VectorJ tau_ext;                  ///< torque of the world on the joints, N m
  Vector6 F_ext = Vector6::Zero();  ///< wrench of the world on the tip, base axes, N and N m
  Vector6 A_BT = Vector6::Zero();   ///< dV_BT/dt, filtered, m/s^2 and rad/s^2
};

/// What the cycle adds to the law's torque.
struct Composition {
  bool gravity = true;      ///< + g
  bool coriolis = false;    ///< + C v
  bool null_space = false;  ///< + N (-K_null (q - q_null) - D_null v)
};

/// The composition with the user's choice of the model terms.
inline Composition with_bias(Composition composition, Bias bias) noexcept {
  if (bias == Bias::kOfLaw) return composition;
  composition.gravity = bias != Bias::kNone;
  composition.coriolis = bias == Bias::kGravityCoriolis;
  return composition;
}

/// Everything a law may look at, of the same instant. The references outlive the call only.
struct LawInputs {
  const ArmState& state;     ///< q, v on the side the law looks at, see Position
  const ArmState& measured;  ///< as the joints report it
  const ArmTerms& terms;
  const Goal& goal;    ///< after interpolation
  const Gains& gains;  ///< after ramps, in base axes
  const Estimates& estimates;
  double dt_s = 0.0;          ///< since the law's last cycle
  bool stiffness_due = true;  ///< what a law derives from K_x, it may derive anew
  bool damping_due = true;    ///< the same for damping
};

/// The law's torque by parts, N m, n each; their sum is what counts.
struct LawOutput {
  explicit LawOutput(int joints)
      : tau_stiffness(VectorJ::Zero(joints)),
        tau_damping(VectorJ::Zero(joints)),
        tau_feedforward(VectorJ::Zero(joints)),
        preload(VectorJ::Zero(joints)),
        sigma(VectorJ::Zero(joints)) {}

  void reset() noexcept {
    tau_stiffness.setZero();
    tau_damping.setZero();
    tau_feedforward.setZero();
    F.setZero();
    F_other.setZero();
    preload.setZero();
    sigma.setZero();
    sets_preload = false;
    fit_residual = 0.0;
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
  bool sets_preload = false;          ///< false: the preload goes to robot.yaml's
  VectorJ preload;                    ///< of two motors, wanted, rad
  VectorJ sigma;                      ///< stiffness asked of the springs, N m/rad; zero if none is
  double fit_residual = 0.0;          ///< share of the wanted tip stiffness that they miss
  double spring_energy_J = 0.0;       ///< potential whose gradient tau_stiffness is, if it is one
  std::int32_t limits = 0;            ///< controller_status_t LIMIT_* bits
};

class Law {
 public:
  virtual ~Law() = default;
  /// nullptr, or what in these gains does not suit this arm. May be called in the cycle.
  virtual const char* refuse(const Gains& gains) noexcept {
    static_cast<void>(gains);
    return nullptr;
  }
  /// The law becomes the active one: forget the past. In the cycle.
  virtual void start(const LawInputs& inputs) noexcept { static_cast<void>(inputs); }
  /// One cycle; `output` has been reset. No allocation, lock, log or exception.
  virtual void compute(const LawInputs& inputs, LawOutput* output) noexcept = 0;
};

/// One line of the registry.
struct LawEntry {
  const char* name;
  const char* summary;  ///< one line for --list-laws
  unsigned needs;       ///< sensors::*
  Follows follows;
  Composition composition;
  StaticForm statics = StaticForm::kNone;
  /// nullptr, or what in these gains the law cannot work with. May be called in the cycle.
  const char* (*refuse)(const Gains& gains, int joints) = nullptr;
  /// Makes the law for an arm that has what it needs. May throw ConfigError.
  std::unique_ptr<Law> (*make)(const LoadedRobot& robot) = nullptr;
};

}  // namespace limber::controller
