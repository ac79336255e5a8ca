#include "controller/kinds/law_parameters.h"

namespace limber::controller {

LawParameters::LawParameters(int joints, LawRows rows) noexcept : rows_(rows) {
  matrices_.fill(MatrixJ::Zero(joints, joints));
  for (const GainRow* row : rows_) {
    if (row->per_joint) {
      matrices_[index(*row)].diagonal().setConstant(row->standard);
    } else {
      scalars_[index(*row)] = row->standard;
    }
  }
}

bool LawParameters::jumps_from(const LawParameters& other) const noexcept {
  for (const GainRow* row : rows_) {
    if (row->ramps) continue;
    const std::size_t i = index(*row);
    if (row->per_joint ? matrices_[i] != other.matrices_[i] : scalars_[i] != other.scalars_[i]) {
      return true;
    }
  }
  return false;
}

void LawParameters::mix(double s, const LawParameters& from, const LawParameters& to) noexcept {
  for (const GainRow* row : rows_) {
    if (!row->ramps) continue;
    const std::size_t i = index(*row);
    matrices_[i] = (1.0 - s) * from.matrices_[i] + s * to.matrices_[i];
  }
}

}  // namespace limber::controller
