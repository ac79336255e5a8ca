// What there is to know of a law without running it: one line of the registry.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "controller/kinds/law_settings.h"
#include "controller/kinds/sensors.h"
#include "lcmtypes/gains_table.h"
#include "robots/loader/robot.h"

namespace limber::controller {

class ArmModel;  // model/arm_terms.h
class Law;       // laws/law.h

/// The arm that a law is made for; both outlive the call only.
struct LawArm {
  const Robot& robot;
  const ArmModel& model;  ///< to be copied by a law that evaluates it at other states
};

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

/// A quantity that a law reports besides its torque, in controller_status_t::law_outputs.
struct LawReport {
  const char* key;
  const char* unit;
  const char* meaning;
  bool per_joint = false;
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
  std::unique_ptr<Law> (*make)(const LawArm& arm) = nullptr;
};

}  // namespace limber::controller
