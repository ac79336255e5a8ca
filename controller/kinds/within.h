#pragma once

namespace limber::controller {

/// NaN is within nothing. May be used in the cycle.
constexpr bool within(double x, double low, double high) noexcept { return x >= low && x <= high; }

}  // namespace limber::controller
