#include "controller/gains/gains_check.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "common/overloaded.h"
#include "common/types.h"
#include "controller/kinds/within.h"
#include "lcmtypes/gains_merge.h"

namespace limber::controller {
namespace {

using Message = compliance_gains_t;

// What rounding may do to a matrix that was symmetric and positive semidefinite on paper; floats
// carry seven digits.
constexpr double kRounding = 1e-9;
constexpr double kFloatRounding = 1e-6;

std::string refusal_of(const GainRow& row) {
  if (row.is_choice() && !std::holds_alternative<std::int16_t(Message::*)[5]>(row.field)) {
    std::string words;
    for (const GainWord& word : row.words) {
      words += fmt::format("{}{}", words.empty() ? "" : ", ", word.word);
    }
    return fmt::format("{} must be one of {}", row.key, words);
  }
  const std::string unit = row.unit[0] == '\0' ? "" : fmt::format(" {}", row.unit);
  if (row.high_rotation > 0.0) {
    return fmt::format(
        "{}: the diagonal must be within {:g}..{:g} (translation) and {:g}..{:g} "
        "(rotation){}",
        row.key, row.low, row.high, row.low < 0.0 ? -row.high_rotation : 0.0, row.high_rotation,
        unit);
  }
  return fmt::format("{} must be within {:g}..{:g}{}", row.key, row.low, row.high, unit);
}

template <typename T>
Matrix6 to_matrix(const T (&values)[6][6]) noexcept {
  Matrix6 M;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) M(i, j) = static_cast<double>(values[i][j]);
  }
  return M;
}

}  // namespace

GainsCheck::Row GainsCheck::make_row(const GainRow& row) {
  const auto told = [&row](const char* what) { return fmt::format("{} {}", row.key, what); };
  return {&row,
          refusal_of(row),
          told("demonstrates a mistake and is allowed only where every bus is simulated"),
          told("is not finite"),
          told("is not symmetric"),
          told("is not positive semidefinite")};
}

GainsCheck::GainsCheck(int joints, bool simulated, LawRows rows)
    : joints_(joints), simulated_(simulated), ramp_(make_row(ramp_row())) {
  for (const GainRow& row : gain_table()) rows_.push_back(make_row(row));
  for (const GainRow* row : rows) parameters_.push_back(make_row(*row));
}

const char* GainsCheck::check(const Message& request, const Message& merged) const noexcept {
  if (request.num_joints != joints_) return "num_joints is not the number of joints of this arm";
  if (request.scope != Message::SCOPE_ALL && request.scope != Message::SCOPE_NAMED)
    return "scope is neither SCOPE_ALL nor SCOPE_NAMED";
  if (unknown_gain(request) != nullptr) return "named: no field has a key of this name";
  if (const char* reason = check_row(ramp_, request)) return reason;
  for (const Row& row : rows_) {
    if (const char* reason = check_row(row, merged)) return reason;
  }
  return check_parameters(request);
}

const char* GainsCheck::check_choice(const Row& row, double value) const noexcept {
  for (const GainWord& word : row.row->words) {
    if (value != static_cast<double>(word.value)) continue;
    return word.demonstration && !simulated_ ? row.demonstration.c_str() : nullptr;
  }
  return row.refusal.c_str();
}

const char* GainsCheck::check_tip_matrix(const Row& row, const Matrix6& M,
                                         double rounding) noexcept {
  const GainRow& r = *row.row;
  if (!M.allFinite()) return row.not_finite.c_str();
  for (int i = 0; i < 6; ++i) {
    const double high = i < 3 ? r.high : r.high_rotation;
    if (!within(M(i, i), r.low < 0.0 ? -high : 0.0, high)) return row.refusal.c_str();
  }
  const double largest = M.cwiseAbs().maxCoeff();
  if (!((M - M.transpose()).cwiseAbs().maxCoeff() <= rounding * largest)) {
    return row.not_symmetric.c_str();
  }
  if (!(largest <= r.high)) return row.refusal.c_str();
  if (r.low < 0.0) return nullptr;
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(M, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().minCoeff() >= -rounding * largest ? nullptr : row.indefinite.c_str();
}

const char* GainsCheck::check_row(const Row& row, const Message& message) const noexcept {
  const GainRow& r = *row.row;
  const auto verdict = [&row](bool allowed) -> const char* {
    return allowed ? nullptr : row.refusal.c_str();
  };
  const auto number = [&](double value) { return verdict(within(value, r.low, r.high)); };
  const auto numbers = [&](const auto& values, int count) {
    return verdict(std::all_of(values, values + count, [&r](auto x) {
      return within(static_cast<double>(x), r.low, r.high);
    }));
  };
  return std::visit(Overloaded{
                        [&](std::monostate) { return verdict(true); },
                        [&](double Message::*f) { return number(message.*f); },
                        [&](float Message::*f) { return number(static_cast<double>(message.*f)); },
                        [&](std::int8_t Message::*f) { return check_choice(row, message.*f); },
                        [&](double(Message::*f)[16]) { return numbers(message.*f, joints_); },
                        [&](float(Message::*f)[16]) { return numbers(message.*f, joints_); },
                        [&](std::int16_t(Message::*f)[5]) { return numbers(message.*f, 5); },
                        [&](double(Message::*f)[6][6]) {
                          return check_tip_matrix(row, to_matrix(message.*f), kRounding);
                        },
                        [&](float(Message::*f)[6][6]) {
                          return check_tip_matrix(row, to_matrix(message.*f), kFloatRounding);
                        },
                    },
                    r.field);
}

const char* GainsCheck::check_parameters(const Message& message) const noexcept {
  for (const law_parameter_t& given : message.parameters) {
    const auto row = std::find_if(parameters_.begin(), parameters_.end(),
                                  [&](const Row& r) { return given.key == r.row->key; });
    if (row == parameters_.end()) return "parameters: no law has a parameter of this name";
    const std::size_t size = row->row->per_joint ? static_cast<std::size_t>(joints_) : 1;
    if (given.values.size() != size) {
      return "parameters: a parameter needs one value, or one value a joint";
    }
    for (const float value : given.values) {
      const double x = static_cast<double>(value);
      if (row->row->is_choice()) {
        if (const char* reason = check_choice(*row, x)) return reason;
      } else if (!within(x, row->row->low, row->row->high)) {
        return row->refusal.c_str();
      }
    }
  }
  return nullptr;
}

}  // namespace limber::controller
