#include "scenarios/gains_yaml.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/types.h"

namespace limber {
namespace {

constexpr Range kRatio = {0.0, 2.0};
constexpr Range kJointStiffness = {0.0, 1e4};
constexpr Range kJointDamping = {0.0, 1e3};
constexpr Range kTranslation = {0.0, 1e5};
constexpr Range kRotation = {0.0, 1e4};

void set_block(const std::vector<double>& diagonal, int first, compliance_gains_t* gains) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 6; ++j) gains->K_x[first + i][j] = gains->K_x[j][first + i] = 0.0;
  }
  for (int i = 0; i < 3; ++i)
    gains->K_x[first + i][first + i] = diagonal[static_cast<std::size_t>(i)];
}

void read_matrix(const YamlMap& yaml, compliance_gains_t* gains) {
  const auto values = yaml.matrix("K_x", 6, 6, {-1e5, 1e5});
  const auto K = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(values.data());
  const double largest = K.cwiseAbs().maxCoeff();
  Eigen::Index row = 0;
  Eigen::Index column = 0;
  if (!((K - K.transpose()).cwiseAbs().maxCoeff(&row, &column) <= 1e-9 * largest)) {
    yaml.refuse("K_x", fmt::format("is not symmetric: row {} column {} holds {}, the other way "
                                   "round it is {}",
                                   row + 1, column + 1, K(row, column), K(column, row)));
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(K, Eigen::EigenvaluesOnly);
  const double smallest = solver.eigenvalues()[0];
  if (!(smallest >= -1e-9 * largest)) {
    yaml.refuse("K_x", fmt::format("is not positive semidefinite: smallest eigenvalue {:.6g}; such "
                                   "a spring would push the arm away",
                                   smallest));
  }
  for (int i = 0; i < 6; ++i) {
    const Range range = i < 3 ? kTranslation : kRotation;
    if (!(K(i, i) <= range.high)) {
      yaml.refuse("K_x", fmt::format("row {} column {}: {} is above {}", i + 1, i + 1, K(i, i),
                                     range.high));
    }
    for (int j = 0; j < 6; ++j) gains->K_x[i][j] = K(i, j);
  }
}

void read_joint_values(const YamlMap& yaml, const std::string& key, int n, Range range,
                       double* values) {
  if (!yaml.has(key)) return;
  const auto given = yaml.numbers(key, n, range, true);
  std::copy(given.begin(), given.end(), values);
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
  gains.orientation = compliance_gains_t::ORIENTATION_LOG;
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
  if (yaml.has("orientation")) {
    gains->orientation = yaml.word("orientation", {"log", "quat"}) == "log"
                             ? compliance_gains_t::ORIENTATION_LOG
                             : compliance_gains_t::ORIENTATION_QUAT;
  }
  const bool translation = yaml.has("K_x_translation_N_per_m");
  const bool rotation = yaml.has("K_x_rotation_Nm_per_rad");
  if (yaml.has("K_x")) {
    if (translation || rotation)
      yaml.refuse("K_x", "is the whole matrix; give either it or its diagonal blocks");
    read_matrix(yaml, gains);
  }
  if (translation)
    set_block(yaml.numbers("K_x_translation_N_per_m", 3, kTranslation, true), 0, gains);
  if (rotation) set_block(yaml.numbers("K_x_rotation_Nm_per_rad", 3, kRotation, true), 3, gains);
  gains->damping_ratio = yaml.number_or("damping_ratio", kRatio, gains->damping_ratio);
  read_joint_values(yaml, "K_q_Nm_per_rad", n, kJointStiffness, gains->K_q);
  gains->joint_damping_ratio =
      yaml.number_or("joint_damping_ratio", kRatio, gains->joint_damping_ratio);
  read_joint_values(yaml, "K_null_Nm_per_rad", n, kJointStiffness, gains->K_null);
  read_joint_values(yaml, "D_null_Nms_per_rad", n, kJointDamping, gains->D_null);
  yaml.finish();
}

}  // namespace limber
