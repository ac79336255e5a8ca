// Checks a gains message against the table.
#pragma once

#include <limber/compliance_gains_t.hpp>
#include <string>
#include <vector>

#include "common/types.h"
#include "controller/kinds/law_parameters.h"
#include "lcmtypes/gains_table.h"

namespace limber::controller {

/// Every row of the table and of the laws' parameters: finite, within its range or one of its
/// words, tip matrices symmetric and, where the row starts at zero, positive semidefinite.
class GainsCheck {
 public:
  /// `simulated`: every bus is; only then choices that demonstrate a mistake are allowed. Set-up
  /// only.
  GainsCheck(int joints, bool simulated, LawRows rows);

  /// nullptr if the request is allowed, else what is wrong. `merged`: the gains as they would be
  /// after it, see merge_gains(). May be called in the cycle.
  const char* check(const compliance_gains_t& request,
                    const compliance_gains_t& merged) const noexcept;

 private:
  struct Row {
    const GainRow* row;
    std::string refusal;
    std::string demonstration;  // why such a word is refused
    std::string not_finite;
    std::string not_symmetric;
    std::string indefinite;
  };

  static Row make_row(const GainRow& row);
  const char* check_row(const Row& row, const compliance_gains_t& message) const noexcept;
  static const char* check_tip_matrix(const Row& row, const Matrix6& M, double rounding) noexcept;
  const char* check_parameters(const compliance_gains_t& message) const noexcept;
  const char* check_choice(const Row& row, double value) const noexcept;

  int joints_;
  bool simulated_;
  Row ramp_;
  std::vector<Row> rows_;
  std::vector<Row> parameters_;
};

}  // namespace limber::controller
