#include "lcmtypes/gains_table.h"

#include <algorithm>

namespace limber {
namespace {

using M = compliance_gains_t;

// The words of the choices; the first is the default unless the row names another.
constexpr GainWord kPosition[] = {{"auto", M::POSITION_AUTO},
                                  {"link", M::POSITION_LINK},
                                  {"motor", M::POSITION_MOTOR},
                                  {"static", M::POSITION_STATIC}};
constexpr GainWord kOrientation[] = {{"log", M::ORIENTATION_LOG},
                                     {"quat", M::ORIENTATION_QUAT},
                                     {"log_simple", M::ORIENTATION_LOG_SIMPLE},
                                     {"quat_simple", M::ORIENTATION_QUAT_SIMPLE},
                                     {"rpy", M::ORIENTATION_RPY}};
constexpr GainWord kFrame[] = {{"base", M::FRAME_BASE}, {"goal", M::FRAME_GOAL}};
constexpr GainWord kCompensation[] = {{"law_default", M::COMPENSATION_LAW_DEFAULT},
                                      {"none", M::COMPENSATION_NONE},
                                      {"gravity", M::COMPENSATION_GRAVITY},
                                      {"gravity_coriolis", M::COMPENSATION_GRAVITY_CORIOLIS}};
constexpr GainWord kDamping[] = {{"double_diagonalisation", M::DAMPING_DOUBLE_DIAGONALISATION},
                                 {"factorisation", M::DAMPING_FACTORISATION},
                                 {"given", M::DAMPING_GIVEN},
                                 {"without_inertia", M::DAMPING_WITHOUT_INERTIA}};
constexpr GainWord kStiffnessTerms[] = {{"first", M::STIFFNESS_FIRST},
                                        {"geometric", M::STIFFNESS_GEOMETRIC},
                                        {"full", M::STIFFNESS_FULL}};
constexpr GainWord kProjector[] = {{"dynamic", M::PROJECTOR_DYNAMIC},
                                   {"kinematic", M::PROJECTOR_KINEMATIC},
                                   {"none", M::PROJECTOR_NONE}};
constexpr GainWord kContact[] = {{"none", M::CONTACT_NONE},
                                 {"tip_sensor", M::CONTACT_TIP_SENSOR},
                                 {"joint_torque", M::CONTACT_JOINT_TORQUE}};
constexpr GainWord kVelocity[] = {{"drive", M::VELOCITY_DRIVE},
                                  {"filtered_difference", M::VELOCITY_FILTERED_DIFFERENCE},
                                  {"alpha_beta", M::VELOCITY_ALPHA_BETA},
                                  {"levant", M::VELOCITY_LEVANT}};
constexpr GainWord kFriction[] = {{"none", M::FRICTION_NONE},
                                  {"model", M::FRICTION_MODEL},
                                  {"observer", M::FRICTION_OBSERVER},
                                  {"dither", M::FRICTION_DITHER}};
constexpr GainWord kTerms[] = {{"jacobian", M::PERIOD_J},
                               {"inertia", M::PERIOD_M},
                               {"coriolis", M::PERIOD_C},
                               {"stiffness", M::PERIOD_K},
                               {"damping", M::PERIOD_D}};
constexpr GainWord kSwitch[] = {{"false", 0}, {"true", 1}};

// clang-format off
const GainRow kTable[] = {
    {.key = "K_x", .meaning = "Cartesian stiffness, the whole matrix: symmetric, positive semidefinite",
     .unit = "N/m, N/rad, N m/rad", .high = 1e5, .high_rotation = 1e4, .from_robot = true, .field = &M::K_x},
    {.key = "damping_ratio", .meaning = "of every Cartesian mode", .high = 2.0, .from_robot = true,
     .field = &M::damping_ratio},
    {.key = "D_x", .meaning = "Cartesian damping for `damping: given`: symmetric, positive semidefinite",
     .unit = "N s/m, N s/rad, N m s/rad", .high = 1e4, .high_rotation = 1e3, .field = &M::D_x},
    {.key = "M_x", .meaning = "symmetric; `opspace_impedance`, `admittance`: inertia of the tip, 0: the arm's own; "
                              "`accel_feedback`: what is added to it, may be negative",
     .unit = "kg, kg m, kg m²", .low = -1e3, .high = 1e3, .high_rotation = 1e2, .field = &M::M_x},
    {.key = "K_q_Nm_per_rad", .meaning = "joint stiffness", .unit = "N m/rad", .high = 1e4, .from_robot = true,
     .field = &M::K_q},
    {.key = "joint_damping_ratio", .meaning = "of every joint mode", .high = 2.0, .from_robot = true,
     .field = &M::joint_damping_ratio},
    {.key = "D_q_Nms_per_rad", .meaning = "joint damping for `joint_damping: given`", .unit = "N m s/rad", .high = 1e3,
     .field = &M::D_q},
    {.key = "K_null_Nm_per_rad", .meaning = "stiffness of the posture in the null space", .unit = "N m/rad",
     .high = 1e4, .from_robot = true, .field = &M::K_null},
    {.key = "D_null_Nms_per_rad", .meaning = "damping in the null space", .unit = "N m s/rad", .high = 1e3,
     .from_robot = true, .field = &M::D_null},

    {.key = "friction_share", .meaning = "share of the friction that is compensated", .high = 1.0, .standard = 0.8,
     .field = &M::friction_share},
    {.key = "velocity_cutoff_rad_per_s", .meaning = "cutoff of `velocity: filtered_difference`", .unit = "rad/s",
     .low = 1e-3, .high = 1e4, .standard = 300.0, .field = &M::velocity_cutoff_rad_per_s},
    {.key = "velocity_acceleration_rad_per_s2",
     .meaning = "bound of the joint acceleration for the other velocity estimators", .unit = "rad/s²", .low = 1e-3,
     .high = 1e5, .standard = 50.0, .field = &M::velocity_acceleration_rad_per_s2},
    {.key = "acceleration_filter_s", .meaning = "time constant of the tip acceleration's filter", .unit = "s",
     .low = 1e-6, .high = 1.0, .standard = 0.005, .field = &M::acceleration_filter_s},
    {.key = "observer_gain_per_s", .meaning = "gain of the momentum observer", .unit = "1/s", .low = 1e-3,
     .high = 500.0, .standard = 50.0, .field = &M::observer_gain_per_s},
    {.key = "friction_observer_gain_per_s", .meaning = "gain of the friction observer", .unit = "1/s", .low = 1e-3,
     .high = 500.0, .standard = 100.0, .field = &M::friction_observer_gain_per_s},
    {.key = "tank_J", .meaning = "energy that a change of `K_x` may draw from; 0: no tank", .unit = "J", .high = 100.0,
     .field = &M::tank_J},
    {.key = "passivity_damping_Ns_per_m",
     .meaning = "most damping that the passivity controller may add at the tip; 0: observed only", .unit = "N s/m",
     .high = 1e3, .field = &M::passivity_damping_Ns_per_m},
    {.key = "spring_force_N", .meaning = "bound of the Cartesian spring's force", .unit = "N", .low = 1e-3,
     .high = 1e4, .standard = 100.0, .field = &M::spring_force_N},
    {.key = "spring_moment_Nm", .meaning = "bound of the Cartesian spring's moment", .unit = "N m", .low = 1e-3,
     .high = 1e4, .standard = 30.0, .field = &M::spring_moment_Nm},
    {.key = "period_cycles", .meaning = "cycles between evaluations of each term", .unit = "cycles", .low = 1.0,
     .high = 1000.0, .standard = 1.0, .words = kTerms, .field = &M::period_cycles},

    {.key = "position_feedback", .meaning = "position that the law receives on elastic joints: measured link, motor, or "
                                            "the link's static equilibrium at the motor position; auto: static where "
                                            "the law has a potential, else motor",
     .words = kPosition, .field = &M::position_feedback},
    {.key = "orientation", .meaning = "parametrisation of the rotation error", .words = kOrientation,
     .field = &M::orientation},
    {.key = "frame", .meaning = "axes in which `K_x`, `D_x` and `M_x` are given", .words = kFrame, .field = &M::frame},
    {.key = "model_compensation", .meaning = "model torque that is added to the law's", .words = kCompensation,
     .field = &M::model_compensation},
    {.key = "damping", .meaning = "source of the Cartesian damping", .words = kDamping, .field = &M::damping},
    {.key = "joint_damping", .meaning = "source of the joint damping", .words = kDamping, .field = &M::joint_damping},
    {.key = "stiffness_terms",
     .meaning = "terms of a Cartesian stiffness in joint coordinates (`congruence_stiffness`, "
                "`mapped_joint_impedance`, `multirate_impedance`)",
     .standard = M::STIFFNESS_FULL, .words = kStiffnessTerms, .field = &M::stiffness_terms},
    {.key = "projector", .meaning = "of the null-space torque", .words = kProjector, .field = &M::projector},
    {.key = "contact", .meaning = "source of the contact torque and wrench", .words = kContact, .field = &M::contact},
    {.key = "velocity", .meaning = "source of the joint velocities", .words = kVelocity, .field = &M::velocity},
    {.key = "friction_compensation", .meaning = "how friction is compensated", .words = kFriction,
     .field = &M::friction_compensation},
};

const GainRow kTranslation = {
    .key = "K_x_translation_N_per_m",
    .meaning = "Cartesian stiffness, diagonal block of the translation: one number or three",
    .unit = "N/m", .high = 1e5, .from_robot = true};
const GainRow kRotation = {
    .key = "K_x_rotation_Nm_per_rad",
    .meaning = "Cartesian stiffness, diagonal block of the rotation: one number or three",
    .unit = "N m/rad", .high = 1e4, .from_robot = true};
const GainRow kRamp = {
    .key = "ramp_s", .meaning = "time over which the numbers change; less than 0.1 s counts as 0.1 s",
    .unit = "s", .high = 60.0, .field = &M::ramp_s};
// clang-format on

}  // namespace

std::span<const GainRow> gain_table() noexcept { return kTable; }
const GainRow& translation_stiffness_row() noexcept { return kTranslation; }
const GainRow& rotation_stiffness_row() noexcept { return kRotation; }
const GainRow& ramp_row() noexcept { return kRamp; }
std::span<const GainWord> switch_words() noexcept { return kSwitch; }

compliance_gains_t standard_gains() {
  compliance_gains_t gains{};
  for (const GainRow& row : gain_table()) {
    const double value = row.standard;
    if (const auto* number = std::get_if<double M::*>(&row.field)) {
      gains.** number = value;
    } else if (const auto* single = std::get_if<float M::*>(&row.field)) {
      gains.** single = static_cast<float>(value);
    } else if (const auto* choice = std::get_if<std::int8_t M::*>(&row.field)) {
      gains.** choice = static_cast<std::int8_t>(value);
    } else if (const auto* cycles = std::get_if<std::int16_t(M::*)[5]>(&row.field)) {
      std::fill_n(gains.**cycles, 5, static_cast<std::int16_t>(value));
    }
  }
  return gains;
}

void set_parameter(const std::string& key, std::vector<float> values, compliance_gains_t* gains) {
  std::erase_if(gains->parameters, [&](const law_parameter_t& other) { return other.key == key; });
  law_parameter_t parameter;
  parameter.key = key;
  parameter.num_values = static_cast<std::int8_t>(values.size());
  parameter.values = std::move(values);
  gains->parameters.push_back(std::move(parameter));
  gains->num_parameters = static_cast<std::int8_t>(gains->parameters.size());
}

const GainRow* find_row(std::span<const GainRow* const> rows, std::string_view key) noexcept {
  for (const GainRow* row : rows) {
    if (key == row->key) return row;
  }
  return nullptr;
}

}  // namespace limber
