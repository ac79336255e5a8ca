#include "scenarios/loader/gains_yaml.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/overloaded.h"
#include "common/types.h"
#include "lcmtypes/gains_merge.h"
#include "robots/loader/default_gains.h"

namespace limber {
namespace {

using Message = compliance_gains_t;
using Matrix6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

int read_word(const YamlMap& yaml, const GainRow& row) {
  std::vector<std::string> words;
  for (const GainWord& word : row.words) words.emplace_back(word.word);
  const std::string found = row.is_switch() ? (yaml.boolean_or(row.key, false) ? "true" : "false")
                                            : yaml.word(row.key, words);
  const auto at = std::find(words.begin(), words.end(), found) - words.begin();
  return row.words[static_cast<std::size_t>(at)].value;
}

// Six rows of six, as they stand in the file.
Matrix6d read_tip_matrix(const YamlMap& yaml, const GainRow& row) {
  const Matrix6d M =
      Eigen::Map<const Matrix6d>(yaml.matrix(row.key, 6, 6, {-row.high, row.high}).data());
  const double largest = M.cwiseAbs().maxCoeff();
  Eigen::Index i = 0;
  Eigen::Index j = 0;
  if (!((M - M.transpose()).cwiseAbs().maxCoeff(&i, &j) <= 1e-9 * largest)) {
    yaml.refuse(row.key, fmt::format("is not symmetric: row {} column {} holds {}, the other way "
                                     "round it is {}",
                                     i + 1, j + 1, M(i, j), M(j, i)));
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(M, Eigen::EigenvaluesOnly);
  if (row.low == 0.0 && !(solver.eigenvalues()[0] >= -1e-9 * largest)) {
    yaml.refuse(row.key,
                fmt::format("is not positive semidefinite: smallest eigenvalue {:.6g}; such a "
                            "spring would push the arm away, such a damper would drive it",
                            solver.eigenvalues()[0]));
  }
  for (int k = 0; k < 6; ++k) {
    const double high = k < 3 ? row.high : row.high_rotation;
    if (!(std::abs(M(k, k)) <= high)) {
      yaml.refuse(row.key,
                  fmt::format("row {} column {}: {} is above {}", k + 1, k + 1, M(k, k), high));
    }
  }
  return M;
}

void read_periods(const YamlMap& yaml, const GainRow& row, Message* gains) {
  const YamlMap periods = yaml.map(row.key);
  for (const GainWord& term : row.words) {
    if (!periods.has(term.word)) continue;
    gains->period_cycles[term.value] = static_cast<std::int16_t>(
        periods.integer(term.word, static_cast<long>(row.low), static_cast<long>(row.high)));
    name_gain(part_key(row.key, term.word).c_str(), gains);
  }
  periods.finish();
}

void read_parameter(const YamlMap& yaml, const GainRow& row, int joints, Message* gains) {
  if (row.is_choice()) {
    set_parameter(row.key, {static_cast<float>(read_word(yaml, row))}, gains);
    return;
  }
  const auto given = yaml.numbers(row.key, row.per_joint ? joints : 1, {row.low, row.high}, true);
  set_parameter(row.key, {given.begin(), given.end()}, gains);
}

void read_row(const YamlMap& yaml, const GainRow& row, int joints, Message* gains) {
  if (!yaml.has(row.key)) return;
  const Range range = {row.low, row.high};
  const auto joint_values = [&](auto& values) {
    const auto given = yaml.numbers(row.key, joints, range, true);
    using T = std::remove_reference_t<decltype(values[0])>;
    std::transform(given.begin(), given.end(), values, [](double x) { return static_cast<T>(x); });
  };
  const auto tip_matrix = [&](auto& values) {
    const Matrix6d M = read_tip_matrix(yaml, row);
    using T = std::remove_reference_t<decltype(values[0][0])>;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) values[i][j] = static_cast<T>(M(i, j));
    }
  };
  std::visit(Overloaded{
                 [&](std::monostate) { read_parameter(yaml, row, joints, gains); },
                 [&](double Message::*field) { gains->*field = yaml.number(row.key, range); },
                 [&](float Message::*field) {
                   gains->*field = static_cast<float>(yaml.number(row.key, range));
                 },
                 [&](std::int8_t Message::*field) {
                   gains->*field = static_cast<std::int8_t>(read_word(yaml, row));
                 },
                 [&](double(Message::*field)[16]) { joint_values(gains->*field); },
                 [&](float(Message::*field)[16]) { joint_values(gains->*field); },
                 [&](double(Message::*field)[6][6]) { tip_matrix(gains->*field); },
                 [&](float(Message::*field)[6][6]) { tip_matrix(gains->*field); },
                 [&](std::int16_t(Message::*)[5]) { read_periods(yaml, row, gains); },
             },
             row.field);
  if (!std::holds_alternative<std::monostate>(row.field) &&
      !std::holds_alternative<std::int16_t(Message::*)[5]>(row.field))
    name_gain(row.key, gains);
}

// The block's diagonal; the coupling to the other block is cleared.
void read_stiffness_block(const YamlMap& yaml, const GainRow& row, int first, Message* gains) {
  if (!yaml.has(row.key)) return;
  if (yaml.has("K_x")) {
    yaml.refuse("K_x", "is the whole matrix; give either it or its diagonal blocks");
  }
  const auto diagonal = yaml.numbers(row.key, 3, {row.low, row.high}, true);
  for (int i = first; i < first + 3; ++i) {
    for (int j = 0; j < 6; ++j) gains->K_x[i][j] = gains->K_x[j][i] = 0.0;
  }
  for (int i = 0; i < 3; ++i) {
    gains->K_x[first + i][first + i] = diagonal[static_cast<std::size_t>(i)];
  }
  name_gain(row.key, gains);
}

}  // namespace

Message read_gains_entry(const YamlMap& yaml, const Robot& robot, const LawCatalog& laws) {
  const int n = robot.size();
  Message gains = default_gains(robot);
  gains.law = yaml.has("law") ? yaml.word("law", laws.names) : "";
  gains.scope = yaml.boolean_or("reset", false) ? Message::SCOPE_ALL : Message::SCOPE_NAMED;
  gains.ramp_s = yaml.number_or(ramp_row().key, {ramp_row().low, ramp_row().high}, 0.0);
  for (const GainRow& row : gain_table()) read_row(yaml, row, n, &gains);
  for (const GainRow* row : laws.parameters) read_row(yaml, *row, n, &gains);
  read_stiffness_block(yaml, translation_stiffness_row(), 0, &gains);
  read_stiffness_block(yaml, rotation_stiffness_row(), 3, &gains);
  yaml.finish();
  return gains;
}

}  // namespace limber
