// The count of an absolute encoder.
#pragma once

#include <cmath>

namespace limber::sim {

/// The last mark at or below a position of `counts` counts. Within a billionth of a count below a
/// mark the joint is at the mark: the last bit of an integrator must not decide whether an arm at
/// rest at zero reads 0 or -1. In the cycle.
inline double whole_counts(double counts) noexcept {
  constexpr double kAtTheMark = 1e-9;
  return std::floor(counts + kAtTheMark);
}

}  // namespace limber::sim
