// What a user chooses about a law, as against the numbers in gains.h. Choices change at once; the
// torque fades over.
#pragma once

#include <array>
#include <cstdint>

#include "controller/pose_error.h"

namespace limber::controller {

// Numbers of compliance_gains_t throughout.

/// Which side of an elastic joint the terms are evaluated at and the law looks at. Damping stays at
/// the motor in all of them: across the spring it would feed the joint's oscillation. Rigid joints
/// have only one side.
enum class Position : std::int8_t {
  kOfArm = 0,   ///< kStatic for laws with a static form, else kMotor
  kLink = 1,    ///< q; needs link encoders
  kMotor = 2,   ///< theta: the springs add their own compliance to the law's
  kStatic = 3,  ///< q_bar, where the link rests while the motor is where it is, see qbar.h
};

/// How variable_stiffness finds the stiffness of the joints.
enum class StiffnessFit : std::int8_t {
  kDiagonal = 0,    ///< diagonal of K_x in joint coordinates
  kCompliance = 1,  ///< the compliances that come nearest to K_x^-1
  kJoint = 2,       ///< K_q itself
};

/// Axes in which K_x, D_x and M_x are given. The goal's, not the tip's: in axes that turn with the
/// tip the spring would not be conservative.
enum class GainFrame : std::int8_t { kBase = 0, kGoal = 1 };

/// The model torque added to the law's.
enum class Bias : std::int8_t { kOfLaw = 0, kNone = 1, kGravity = 2, kGravityCoriolis = 3 };

/// Where damping comes from, see damping_design.h.
enum class DampingDesign : std::int8_t {
  kDoubleDiagonalisation = 0,
  kFactorisation = 1,
  kGiven = 2,
  kWithoutInertia = 3,
};

/// Terms of a Cartesian stiffness in joint coordinates, see stiffness_mapping.h.
enum class StiffnessTerms : std::int8_t { kFirst = 0, kGeometric = 1, kFull = 2 };

/// Pose at which eq7 evaluates it.
enum class StiffnessPose : std::int8_t { kCurrent = 0, kGoal = 1, kMid = 2, kMean = 3 };

/// What happens to the partial derivative of the damping torque with respect to the joint angles.
enum class DampingPartials : std::int8_t {
  kNone = 0,         ///< left out, as usual
  kInStiffness = 1,  ///< part of the stiffness, where its unit belongs
  kPrinted = 2,      ///< added to the damping, as one finds it printed; may feed energy in
};

enum class Projector : std::int8_t { kDynamic = 0, kKinematic = 1, kNone = 2 };

enum class ContactSource : std::int8_t { kNone = 0, kTipSensor = 1, kJointTorque = 2 };

enum class VelocitySource : std::int8_t {
  kDrive = 0,
  kFilteredDifference = 1,
  kAlphaBeta = 2,
  kLevant = 3,
};

enum class FrictionCompensation : std::int8_t { kNone = 0, kModel = 1, kObserver = 2 };

/// Terms with an evaluation period of their own.
enum class Term : std::uint8_t { kJacobian, kInertia, kCoriolis, kStiffness, kDamping };
inline constexpr int kTerms = 5;

struct LawSettings {
  bool operator==(const LawSettings&) const = default;

  Position position = Position::kOfArm;
  StiffnessFit stiffness_fit = StiffnessFit::kDiagonal;
  Orientation orientation = Orientation::kLog;
  GainFrame frame = GainFrame::kBase;
  Bias bias = Bias::kOfLaw;
  DampingDesign damping = DampingDesign::kDoubleDiagonalisation;
  DampingDesign joint_damping = DampingDesign::kDoubleDiagonalisation;
  StiffnessTerms stiffness_terms = StiffnessTerms::kFull;
  StiffnessPose stiffness_pose = StiffnessPose::kMid;
  DampingPartials damping_partials = DampingPartials::kNone;
  Projector projector = Projector::kDynamic;
  ContactSource contact = ContactSource::kNone;
  VelocitySource velocity = VelocitySource::kDrive;
  FrictionCompensation friction = FrictionCompensation::kNone;
  double friction_share = 0.8;
  bool inertia_feedforward = false;
  bool follow_velocity = true;
  bool literal_stiffness = false;
  double velocity_cutoff_rad_per_s = 300.0;
  double velocity_acceleration_rad_per_s2 = 50.0;
  double acceleration_filter_s = 0.005;
  double observer_gain_per_s = 50.0;
  double friction_observer_gain_per_s = 100.0;
  double torque_gain = 0.0;  ///< K_T of full_state
  double tank_J = 0.0;
  double passivity_damping_Ns_per_m = 0.0;
  double spring_force_N = 100.0;
  double spring_moment_Nm = 30.0;
  double lost_share = 1e-4;  ///< see kLostShare in nullspace.h; not for users
  /// Cycles between evaluations, in the order of Term.
  std::array<int, kTerms> period_cycles = {1, 1, 1, 1, 1};
};

}  // namespace limber::controller
