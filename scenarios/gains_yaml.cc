#include "scenarios/gains_yaml.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/types.h"
#include "scenarios/values_yaml.h"

namespace limber {
namespace {

constexpr Range kRatio = {0.0, 2.0};
constexpr Range kJointStiffness = {0.0, 1e4};
constexpr Range kJointDamping = {0.0, 1e3};
constexpr Range kTranslation = {0.0, 1e5};
constexpr Range kRotation = {0.0, 1e4};
constexpr float kDefaultStiffnessPerInertia_per_s2 = 100.0F;

void set_block(const std::vector<double>& diagonal, int first, compliance_gains_t* gains) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 6; ++j) gains->K_x[first + i][j] = gains->K_x[j][first + i] = 0.0;
  }
  for (int i = 0; i < 3; ++i)
    gains->K_x[first + i][first + i] = diagonal[static_cast<std::size_t>(i)];
}

using Matrix6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

// Six rows of six, symmetric, as they stand in the file.
Matrix6d read_symmetric(const YamlMap& yaml, const std::string& key, Range range) {
  const auto values = yaml.matrix(key, 6, 6, range);
  const Matrix6d K = Eigen::Map<const Matrix6d>(values.data());
  const double largest = K.cwiseAbs().maxCoeff();
  Eigen::Index row = 0;
  Eigen::Index column = 0;
  if (!((K - K.transpose()).cwiseAbs().maxCoeff(&row, &column) <= 1e-9 * largest)) {
    yaml.refuse(key, fmt::format("is not symmetric: row {} column {} holds {}, the other way "
                                 "round it is {}",
                                 row + 1, column + 1, K(row, column), K(column, row)));
  }
  return K;
}

Matrix6d read_semidefinite(const YamlMap& yaml, const std::string& key, Range range,
                           const std::string& consequence) {
  const Matrix6d K = read_symmetric(yaml, key, range);
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(K, Eigen::EigenvaluesOnly);
  const double smallest = solver.eigenvalues()[0];
  if (!(smallest >= -1e-9 * K.cwiseAbs().maxCoeff())) {
    yaml.refuse(key, fmt::format("is not positive semidefinite: smallest eigenvalue {:.6g}; {}",
                                 smallest, consequence));
  }
  return K;
}

// The diagonal's bounds differ between translation and rotation.
void check_diagonal(const YamlMap& yaml, const std::string& key, const Matrix6d& M, double linear,
                    double angular) {
  for (int i = 0; i < 6; ++i) {
    const double high = i < 3 ? linear : angular;
    if (!(std::abs(M(i, i)) <= high)) {
      yaml.refuse(key,
                  fmt::format("row {} column {}: {} is above {}", i + 1, i + 1, M(i, i), high));
    }
  }
}

template <typename T>
void store(const Matrix6d& M, T (&field)[6][6]) {
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) field[i][j] = static_cast<T>(M(i, j));
  }
}

void read_stiffness(const YamlMap& yaml, compliance_gains_t* gains) {
  const Matrix6d K =
      read_semidefinite(yaml, "K_x", {-1e5, 1e5}, "such a spring would push the arm away");
  check_diagonal(yaml, "K_x", K, kTranslation.high, kRotation.high);
  store(K, gains->K_x);
}

void read_damping_and_inertia(const YamlMap& yaml, compliance_gains_t* gains) {
  if (yaml.has("D_x")) {
    const Matrix6d D =
        read_semidefinite(yaml, "D_x", {-1e4, 1e4}, "such a damper would drive the arm");
    check_diagonal(yaml, "D_x", D, 1e4, 1e3);
    store(D, gains->D_x);
  }
  if (!yaml.has("M_x")) return;
  const Matrix6d M = read_symmetric(yaml, "M_x", {-1e3, 1e3});
  check_diagonal(yaml, "M_x", M, 1e3, 1e2);
  store(M, gains->M_x);
}

template <typename T>
void read_joint_values(const YamlMap& yaml, const std::string& key, int n, Range range, T* values) {
  if (!yaml.has(key)) return;
  const auto given = yaml.numbers(key, n, range, true);
  std::transform(given.begin(), given.end(), values, [](double x) { return static_cast<T>(x); });
}

void read_float(const YamlMap& yaml, const std::string& key, Range range, float* value) {
  *value = static_cast<float>(yaml.number_or(key, range, static_cast<double>(*value)));
}

void read_choice(const YamlMap& yaml, const std::string& key, const std::vector<std::string>& words,
                 std::int8_t* value) {
  if (!yaml.has(key)) return;
  *value = static_cast<std::int8_t>(index_of(yaml.word(key, words), words));
}

void read_switch(const YamlMap& yaml, const std::string& key, std::int8_t* value) {
  *value = yaml.boolean_or(key, *value != 0) ? 1 : 0;
}

// The words stand in the order of the message's constants.
void read_choices(const YamlMap& yaml, compliance_gains_t* gains) {
  const std::vector<std::string> designs = {"double_diagonalisation", "factorisation", "given",
                                            "without_inertia"};
  read_choice(yaml, "position", {"of_arm", "link", "motor", "static"}, &gains->position);
  read_choice(yaml, "stiffness_fit", {"diagonal", "compliance", "joint"}, &gains->stiffness_fit);
  read_choice(yaml, "orientation", {"log", "quat", "log_simple", "quat_simple", "rpy"},
              &gains->orientation);
  read_choice(yaml, "frame", {"base", "goal"}, &gains->frame);
  read_choice(yaml, "bias", {"of_law", "none", "gravity", "gravity_coriolis"}, &gains->bias);
  read_choice(yaml, "damping", designs, &gains->damping);
  read_choice(yaml, "joint_damping", designs, &gains->joint_damping);
  read_choice(yaml, "stiffness_terms", {"first", "geometric", "full"}, &gains->stiffness_terms);
  read_choice(yaml, "stiffness_pose", {"current", "goal", "mid", "mean"}, &gains->stiffness_pose);
  read_choice(yaml, "damping_partials", {"none", "in_stiffness", "printed"},
              &gains->damping_partials);
  read_choice(yaml, "projector", {"dynamic", "kinematic", "none"}, &gains->projector);
  read_choice(yaml, "contact", {"none", "tip_sensor", "joint_torque"}, &gains->contact);
  read_choice(yaml, "velocity", {"drive", "filtered_difference", "alpha_beta", "levant"},
              &gains->velocity);
  read_choice(yaml, "friction_compensation", {"none", "model", "observer"}, &gains->friction);
  read_switch(yaml, "inertia_feedforward", &gains->inertia_feedforward);
  read_switch(yaml, "follow_velocity", &gains->follow_velocity);
  read_switch(yaml, "literal_stiffness", &gains->literal_stiffness);
}

void read_settings(const YamlMap& yaml, compliance_gains_t* gains) {
  read_float(yaml, "friction_share", {0.0, 1.0}, &gains->friction_share);
  read_float(yaml, "velocity_cutoff_rad_per_s", {0.0, 1e4}, &gains->velocity_cutoff_rad_per_s);
  read_float(yaml, "velocity_acceleration_rad_per_s2", {0.0, 1e5},
             &gains->velocity_acceleration_rad_per_s2);
  read_float(yaml, "acceleration_filter_s", {0.0, 1.0}, &gains->acceleration_filter_s);
  read_float(yaml, "observer_gain_per_s", {0.0, 500.0}, &gains->observer_gain_per_s);
  read_float(yaml, "friction_observer_gain_per_s", {0.0, 500.0},
             &gains->friction_observer_gain_per_s);
  read_float(yaml, "torque_gain", {0.0, 20.0}, &gains->torque_gain);
  read_float(yaml, "tank_J", {0.0, 100.0}, &gains->tank_J);
  read_float(yaml, "passivity_damping_Ns_per_m", {0.0, 1e3}, &gains->passivity_damping_Ns_per_m);
  read_float(yaml, "spring_force_N", {0.0, 1e4}, &gains->spring_force_N);
  read_float(yaml, "spring_moment_Nm", {0.0, 1e4}, &gains->spring_moment_Nm);
  if (!yaml.has("period_cycles")) return;
  const YamlMap periods = yaml.map("period_cycles");
  const std::vector<std::string> terms = {"jacobian", "inertia", "coriolis", "stiffness",
                                          "damping"};
  for (std::size_t i = 0; i < terms.size(); ++i) {
    gains->period_cycles[i] = static_cast<std::int16_t>(
        periods.integer_or(terms[i], 1, 1000, std::max<long>(gains->period_cycles[i], 1)));
  }
  periods.finish();
}

std::string read_law(const YamlMap& yaml) {
  if (!yaml.has("law")) return "";
  std::string law = yaml.text("law");
  const bool name = law.size() <= 64 && std::all_of(law.begin(), law.end(), [](char c) {
                      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
                    });
  if (!name) yaml.refuse("law", "found '" + law + "'; a law's name has only a-z, 0-9 and _");
  return law;
}

}  // namespace

compliance_gains_t default_gains(const Robot& robot) {
  const DefaultGains& defaults = robot.gains;
  compliance_gains_t gains{};
  gains.stiffness_terms = compliance_gains_t::STIFFNESS_FULL;
  gains.stiffness_pose = compliance_gains_t::POSE_MID;
  gains.follow_velocity = 1;
  gains.friction_share = 0.8F;
  std::fill_n(gains.K_acc, robot.size(), kDefaultStiffnessPerInertia_per_s2);
  gains.num_joints = static_cast<std::int8_t>(robot.size());
  for (int i = 0; i < 6; ++i) {
    gains.K_x[i][i] = i < 3 ? defaults.K_x_translation_N_per_m : defaults.K_x_rotation_Nm_per_rad;
  }
  gains.damping_ratio = defaults.damping_ratio;
  gains.joint_damping_ratio = defaults.joint_damping_ratio;
  std::copy(defaults.K_q.begin(), defaults.K_q.end(), gains.K_q);
  std::copy(defaults.K_null.begin(), defaults.K_null.end(), gains.K_null);
  std::copy(defaults.D_null.begin(), defaults.D_null.end(), gains.D_null);
  return gains;
}

void read_gains_entry(const YamlMap& yaml, const Robot& robot, compliance_gains_t* gains) {
  const int n = robot.size();
  gains->law = read_law(yaml);
  gains->ramp_s = yaml.number_or("ramp_s", {0.0, 30.0}, 0.0);
  read_choices(yaml, gains);
  read_settings(yaml, gains);
  const bool translation = yaml.has("K_x_translation_N_per_m");
  const bool rotation = yaml.has("K_x_rotation_Nm_per_rad");
  if (yaml.has("K_x")) {
    if (translation || rotation)
      yaml.refuse("K_x", "is the whole matrix; give either it or its diagonal blocks");
    read_stiffness(yaml, gains);
  }
  if (translation)
    set_block(yaml.numbers("K_x_translation_N_per_m", 3, kTranslation, true), 0, gains);
  if (rotation) set_block(yaml.numbers("K_x_rotation_Nm_per_rad", 3, kRotation, true), 3, gains);
  read_damping_and_inertia(yaml, gains);
  gains->damping_ratio = yaml.number_or("damping_ratio", kRatio, gains->damping_ratio);
  read_joint_values(yaml, "K_q_Nm_per_rad", n, kJointStiffness, gains->K_q);
  gains->joint_damping_ratio =
      yaml.number_or("joint_damping_ratio", kRatio, gains->joint_damping_ratio);
  read_joint_values(yaml, "K_null_Nm_per_rad", n, kJointStiffness, gains->K_null);
  read_joint_values(yaml, "D_null_Nms_per_rad", n, kJointDamping, gains->D_null);
  read_joint_values(yaml, "D_q_Nms_per_rad", n, kJointDamping, gains->D_q);
  read_joint_values(yaml, "M_q_kgm2", n, {0.0, 1e2}, gains->M_q);
  read_joint_values(yaml, "K_acc_per_s2", n, {0.0, 1e5}, gains->K_acc);
  yaml.finish();
}

}  // namespace limber
