#include "controller/elastic/pair_inverse.h"

#include <algorithm>
#include <cmath>

namespace limber::controller {
namespace {

constexpr double kFarthest_rad = 10.0;
constexpr int kMostSteps = 150;
constexpr double kNarrowest_rad = 1e-14;
constexpr double kClose = 1e-13;  // share of what is wanted that rounding leaves

// Where a rising function reaches `wanted` within [low, high], or the end that is nearer to it.
// False position, the value at an end that stays twice being halved (Illinois; Dowell, Jarratt
// 1971); every third step halves the interval, so that fifty of those are the most it takes.
template <typename Function>
double reach(double low, double high, double wanted, Function f) noexcept {
  double below = f(low) - wanted;
  double above = f(high) - wanted;
  if (!(below < 0.0)) return low;
  if (!(above > 0.0)) return high;
  int side = 0;
  for (int i = 1; i <= kMostSteps && high - low > kNarrowest_rad; ++i) {
    const double share = i % 3 == 0 ? 0.5 : below / (below - above);
    const double x = low + share * (high - low);
    const double value = f(x) - wanted;
    if (std::abs(value) <= kClose * std::abs(wanted)) return x;
    const int now = value < 0.0 ? -1 : 1;
    (now < 0 ? low : high) = x;
    (now < 0 ? below : above) = value;
    if (now == side) (now < 0 ? above : below) *= 0.5;
    side = now;
  }
  return 0.5 * (low + high);
}

}  // namespace

double pair_deflection(const SpringPair& pair, double c, double tau) noexcept {
  // The spring that is stretched more carries half of tau at least, and no more than tau and what
  // the other pulls without it.
  const double size = std::abs(tau);
  const double low = std::max(spring_deflection(pair.spring, 0.5 * size) - c, 0.0);
  const double high = spring_deflection(pair.spring, size + std::max(pair.pull(c), 0.0)) - c;
  const double x = reach(low, std::min(high, kFarthest_rad), size,
                         [&](double at) { return pair.torque(c, at); });
  return std::copysign(x, tau);
}

double least_preload(const SpringPair& pair, double tau) noexcept {
  return 0.5 * std::min(spring_deflection(pair.spring, std::abs(tau)), kFarthest_rad);
}

double pair_preload(const SpringPair& pair, double sigma, double tau, double c_max) noexcept {
  // Of the spring that is stretched more, by how far the other is.
  const auto stretched = [&](double slacker) {
    return spring_deflection(pair.spring, pair.pull(slacker) + std::abs(tau));
  };
  const double slacker = reach(0.0, 2.0 * c_max, sigma,
                               [&](double d) { return pair.slope(stretched(d)) + pair.slope(d); });
  const double least = std::min(least_preload(pair, tau), c_max);
  // The bound first: it also holds where the other is not a number.
  return std::min(std::max(least, 0.5 * (stretched(slacker) + slacker)), c_max);
}

}  // namespace limber::controller
