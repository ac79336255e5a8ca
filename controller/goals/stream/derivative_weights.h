// First and second derivative from values at times that need not be even.
#pragma once

#include <array>
#include <span>

namespace limber::controller {

/// f'(0) = sum first[k] f(times[k]), f''(0) = sum second[k] f(times[k]); exact for polynomials
/// through the values.
struct DerivativeWeights {
  std::array<double, 5> first{}, second{};
};

/// `times`: one to five, different, s. Fornberg, Generation of finite difference formulas on
/// arbitrarily spaced grids, 1988. May be called in the cycle.
DerivativeWeights derivative_weights(std::span<const double> times) noexcept;

}  // namespace limber::controller
