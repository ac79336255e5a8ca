// A first-order lag over a step with its input held: x' = (target - x) / time_constant, exactly.
#pragma once

#include <cmath>

namespace limber::sim {

/// Where x is at the end of the step, and its mean over the step.
struct Course {
  double end = 0.0;
  double mean = 0.0;
};

/// A time constant of zero: x is at its target at once.
inline Course relax(double start, double target, double time_constant, double h) noexcept {
  if (!(time_constant > 0.0)) return {target, target};
  const double share = -std::expm1(-h / time_constant);
  const double gap = target - start;
  return {start + share * gap, target - gap * share * time_constant / h};
}

}  // namespace limber::sim
