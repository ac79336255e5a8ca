#include "controller/elastic/pair_inverse.h"

namespace limber::controller {
namespace {

constexpr double kFarthest_rad = 10.0;
constexpr int kHalvings = 50;

// Where a rising function reaches `wanted` within [low, high].
template <typename Function>
double reach(double low, double high, double wanted, Function f) noexcept {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double pair_deflection(const SpringPair& pair, double c, double tau) noexcept {
  return reach(-kFarthest_rad, kFarthest_rad, tau, [&](double x) { return pair.torque(c, x); });
}

double least_preload(const SpringPair& pair, double tau) noexcept {
  return 0.5 * reach(0.0, kFarthest_rad, std::abs(tau), [&](double d) { return pair.pull(d); });
}

double pair_preload(const SpringPair& pair, double sigma, double tau, double c_max) noexcept {
  const double least = std::min(least_preload(pair, tau), c_max);
  return reach(least, c_max, sigma,
               [&](double c) { return pair.stiffness(c, pair_deflection(pair, c, tau)); });
}

}  // namespace limber::controller
