// What a user chooses about a law, as against the numbers in gains.h. Choices change at once; the
// torque fades over. Numbers of compliance_gains_t throughout.
#pragma once

#include <array>
#include <cstdint>
#include <limber/compliance_gains_t.hpp>

#pragma GCC visibility push(default)
namespace limber::controller {

/// Position that a law receives on elastic joints, and at which the model is evaluated. Damping
/// stays at the motor in all of them: across the spring it would feed the joint's oscillation.
/// Rigid joints have only one position.
enum class PositionFeedback : std::int8_t {
  kAuto = compliance_gains_t::POSITION_AUTO,    ///< kStatic for laws with a potential, else kMotor
  kLink = compliance_gains_t::POSITION_LINK,    ///< q; needs link encoders
  kMotor = compliance_gains_t::POSITION_MOTOR,  ///< theta: springs add their compliance
  kStatic = compliance_gains_t::POSITION_STATIC,  ///< q_bar, static equilibrium of the link at the
                                                  ///< measured motor position, see qbar.h
};

/// How the rotation error e_o is measured (numbers of compliance_gains_t).
enum class Orientation : std::int8_t {
  /// e_o = Log(R R_d^T): an isotropic spring k pulls with k phi up to half a turn, where it jumps.
  kLog = 0,
  /// e_o = 2 epsilon of Q Q_d^-1 with eta >= 0: pulls with k sin phi, weakest beyond 90 degrees,
  /// without a jump of the torque at half a turn.
  kQuat = 1,
  /// The same errors with A = I, as often published: conservative for equal stiffness only.
  kLogSimple = 2,
  kQuatSimple = 3,
  /// Differences of roll, pitch and yaw (R = Rz(y) Ry(p) Rx(r)), each within +-pi: singular at a
  /// pitch of 90 degrees, where its rate is bounded.
  kRollPitchYaw = 4,
};

/// Axes in which K_x, D_x and M_x are given. The goal's, not the tip's: in axes that turn with the
/// tip the spring would not be conservative.
enum class GainFrame : std::int8_t {
  kBase = compliance_gains_t::FRAME_BASE,
  kGoal = compliance_gains_t::FRAME_GOAL,
};

/// The model torque added to the law's.
enum class ModelCompensation : std::int8_t {
  kLawDefault = compliance_gains_t::COMPENSATION_LAW_DEFAULT,
  kNone = compliance_gains_t::COMPENSATION_NONE,
  kGravity = compliance_gains_t::COMPENSATION_GRAVITY,
  kGravityCoriolis = compliance_gains_t::COMPENSATION_GRAVITY_CORIOLIS,
};

/// Where damping comes from, see damping_design.h.
enum class DampingDesign : std::int8_t {
  kDoubleDiagonalisation = compliance_gains_t::DAMPING_DOUBLE_DIAGONALISATION,
  kFactorisation = compliance_gains_t::DAMPING_FACTORISATION,
  kGiven = compliance_gains_t::DAMPING_GIVEN,
  kWithoutInertia = compliance_gains_t::DAMPING_WITHOUT_INERTIA,
};

/// Terms of a Cartesian stiffness in joint coordinates, see stiffness_mapping.h.
enum class StiffnessTerms : std::int8_t {
  kFirst = compliance_gains_t::STIFFNESS_FIRST,
  kGeometric = compliance_gains_t::STIFFNESS_GEOMETRIC,
  kFull = compliance_gains_t::STIFFNESS_FULL,
};

enum class Projector : std::int8_t {
  kDynamic = compliance_gains_t::PROJECTOR_DYNAMIC,
  kKinematic = compliance_gains_t::PROJECTOR_KINEMATIC,
  kNone = compliance_gains_t::PROJECTOR_NONE,
};

enum class ContactSource : std::int8_t {
  kNone = compliance_gains_t::CONTACT_NONE,
  kTipSensor = compliance_gains_t::CONTACT_TIP_SENSOR,
  kJointTorque = compliance_gains_t::CONTACT_JOINT_TORQUE,
};

enum class VelocitySource : std::int8_t {
  kDrive = compliance_gains_t::VELOCITY_DRIVE,
  kFilteredDifference = compliance_gains_t::VELOCITY_FILTERED_DIFFERENCE,
  kAlphaBeta = compliance_gains_t::VELOCITY_ALPHA_BETA,
  kLevant = compliance_gains_t::VELOCITY_LEVANT,
};

enum class FrictionCompensation : std::int8_t {
  kNone = compliance_gains_t::FRICTION_NONE,
  kModel = compliance_gains_t::FRICTION_MODEL,
  kObserver = compliance_gains_t::FRICTION_OBSERVER,
  kDither = compliance_gains_t::FRICTION_DITHER,
};

/// Terms with an evaluation period of their own.
enum class Term : std::uint8_t {
  kJacobian = compliance_gains_t::PERIOD_J,
  kInertia = compliance_gains_t::PERIOD_M,
  kCoriolis = compliance_gains_t::PERIOD_C,
  kStiffness = compliance_gains_t::PERIOD_K,
  kDamping = compliance_gains_t::PERIOD_D,
};
inline constexpr int kTerms = 5;

/// Defaults stand in lcmtypes/gains_table.cc; read_settings() puts them here.
struct LawSettings {
  bool operator==(const LawSettings&) const = default;

  PositionFeedback position_feedback = PositionFeedback::kAuto;
  Orientation orientation = Orientation::kLog;
  GainFrame frame = GainFrame::kBase;
  ModelCompensation model_compensation = ModelCompensation::kLawDefault;
  DampingDesign damping = DampingDesign::kDoubleDiagonalisation;
  DampingDesign joint_damping = DampingDesign::kDoubleDiagonalisation;
  StiffnessTerms stiffness_terms = StiffnessTerms::kFull;
  Projector projector = Projector::kDynamic;
  ContactSource contact = ContactSource::kNone;
  VelocitySource velocity = VelocitySource::kDrive;
  FrictionCompensation friction_compensation = FrictionCompensation::kNone;
  double friction_share = 0.0;
  double velocity_cutoff_rad_per_s = 0.0;
  double velocity_acceleration_rad_per_s2 = 0.0;
  double acceleration_filter_s = 0.0;
  double observer_gain_per_s = 0.0;
  double friction_observer_gain_per_s = 0.0;
  double tank_J = 0.0;
  double passivity_damping_Ns_per_m = 0.0;
  double spring_force_N = 0.0;
  double spring_moment_Nm = 0.0;
  /// Cycles between evaluations, in the order of Term.
  std::array<int, kTerms> period_cycles = {1, 1, 1, 1, 1};
  /// Not of the message, see kLostShare in impedance/nullspace.h.
  double lost_share = 1e-4;
};

/// Those of a message that GainsCheck found nothing wrong with. May be called in the cycle.
LawSettings read_settings(const compliance_gains_t& fields) noexcept;

/// The settings with which nobody has chosen anything; also those of HOLD. The first call is for
/// set-up.
const LawSettings& default_settings() noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
