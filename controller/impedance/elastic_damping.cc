#include "controller/impedance/elastic_damping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <optional>

namespace limber::controller {
namespace {

constexpr int kSteps = 40;
constexpr int kNewtonSteps = 3;  // of each; the first has more
constexpr int kFirstNewtonSteps = 8;
constexpr double kFactor = 5.0;  // of a rigid joint's damping: beyond it D is not looked for
constexpr double kLeastLookedFor = 0.3;  // or of that for this ratio
constexpr double kSwings = 0.75;         // greatest ratio at which a pair is still followed
constexpr double kWorthFrom = 0.15;      // of the ratio asked
constexpr double kWorthFull = 0.3;
constexpr double kNearly = 0.9;  // from here on a ratio above kSwings is in proportion
constexpr double kAgainstDelay = 2.0;
constexpr double kLeastLeft = 0.05;  // of the spring, see QbarSolver

using Root = std::complex<double>;
using Quartic = std::array<double, 5>;  // the constant last

Quartic quartic(const ElasticMode& m, double D, double t_d) noexcept {
  const double late = 0.5 * m.law * t_d * t_d;
  const double r = m.rotor - D * t_d + late;
  const double d = D - m.law * t_d;
  const double at_motor = m.at_link ? 0.0 : 1.0;
  return {m.link * (m.at_link ? r - late : r),
          m.link * (m.damper + (m.at_link ? D : d)) + m.damper * r,
          m.link * (m.spring + at_motor * m.law) + m.damper * d + m.spring * r,
          m.damper * m.law + m.spring * d, m.spring * m.law};
}

// Newton's steps in real numbers: p(z) = b(z) (z^2 - u z + v) + r z + t, where the bracket is zero
// at s and its conjugate, so that p(s) = r s + t and p'(s) = (2 s - u) b(s) + r.
Root refined(const Quartic& p, Root s, int steps) noexcept {
  for (int i = 0; i < steps; ++i) {
    const double x = s.real(), y = s.imag(), u = 2.0 * x, v = x * x + y * y;
    const double b0 = p[0], b1 = p[1] + u * b0, b2 = p[2] + u * b1 - v * b0;
    const double r = p[3] + u * b2 - v * b1, t = p[4] - v * b2;
    const double c1 = b1 + u * b0, c2 = b2 - v * b0;  // b(s) = c1 s + c2
    const double value_x = r * x + t, value_y = r * y;
    const double slope_x = r - 2.0 * y * (c1 * y), slope_y = 2.0 * y * (c1 * x + c2);
    const double over = 1.0 / (slope_x * slope_x + slope_y * slope_y);
    s -= Root(over * (value_x * slope_x + value_y * slope_y),
              over * (value_y * slope_x - value_x * slope_y));
  }
  return s;
}

struct Sample {
  double D = 0.0;
  double ratio = 0.0;
};

// The peak of the parabola through three samples.
Sample peak(const Sample& a, const Sample& b, const Sample& c) noexcept {
  const double left = (b.ratio - a.ratio) / (b.D - a.D);
  const double right = (c.ratio - b.ratio) / (c.D - b.D);
  const double bend = (right - left) / (c.D - a.D);
  if (!(bend < 0.0)) return b;
  const double D = std::clamp(0.5 * (a.D + b.D) - 0.5 * left / bend, a.D, c.D);
  return {D, a.ratio + (D - a.D) * (left + bend * (D - b.D))};
}

// How the damping ratio of the pair that begins as the link on all springs changes with D.
struct Way {
  std::array<Sample, kSteps + 1> samples{};
  int count = 0;

  double ratio_at(double D) const noexcept {
    const auto end = samples.begin() + count;
    const auto next = std::find_if(samples.begin(), end, [D](const Sample& s) { return s.D >= D; });
    if (count == 0) return 0.0;
    if (next == end) return std::prev(end)->ratio;
    if (next == samples.begin()) return next->ratio;
    const Sample& a = *std::prev(next);
    return a.ratio + (D - a.D) / (next->D - a.D) * (next->ratio - a.ratio);
  }
};

// The first D up to `end` with the ratio, or with the greatest; the way ends there.
Sample followed(const ElasticMode& m, double ratio, double end, double t_d, Way* way) noexcept {
  const double at_link = m.at_link ? m.law : m.law * m.spring / (m.law + m.spring);
  Root s(0.0, std::sqrt(at_link / (m.link + m.rotor)));
  std::optional<Sample> found;
  for (int i = 0; i <= kSteps && !found; ++i) {
    const double D = end * i / kSteps;
    s = refined(quartic(m, D, t_d), s, i == 0 ? kFirstNewtonSteps : kNewtonSteps);
    const Sample now{D, -s.real() / std::sqrt(std::norm(s))};
    // The pair has met on the real axis, or is lost.
    if (!(s.imag() > 0.0) || !std::isfinite(now.ratio)) break;
    way->samples[static_cast<std::size_t>(way->count++)] = now;
    const auto last = [way](int back) -> const Sample& {
      return way->samples[static_cast<std::size_t>(way->count - 1 - back)];
    };
    if (now.ratio >= ratio) {
      found = i == 0 ? now
                     : Sample{last(1).D + (ratio - last(1).ratio) / (now.ratio - last(1).ratio) *
                                              (D - last(1).D),
                              ratio};
    } else if (i > 1 && now.ratio < last(1).ratio) {
      found = peak(last(2), last(1), now);
    }
  }
  if (found) return *found;
  return way->count > 0 ? way->samples[static_cast<std::size_t>(way->count - 1)] : Sample{};
}

// 0 up to `from`, 1 beyond `to`, smooth between.
double step_between(double x, double from, double to) noexcept {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

double law_stiffness(PositionFeedback position, double K, double compliance) noexcept {
  if (position != PositionFeedback::kStatic) return K;
  return K / std::max(1.0 - K * compliance, kLeastLeft);
}

ElasticDamping elastic_damping(const ElasticMode& mode, double ratio, double rigid, double most,
                               double t_d) noexcept {
  if (!(mode.law > 0.0) || !(ratio > 0.0)) return {std::min(rigid, most), 0.0};
  const double wanted = std::min(ratio, kSwings);
  const double above = ratio / wanted;
  const double least_seen = std::max(1.0, kLeastLookedFor / ratio);
  const double end = std::min(most, kFactor * least_seen * rigid / above);
  if (!(end > 0.0)) return {};
  Way way;
  const Sample found = followed(mode, wanted, end, t_d, &way);
  const double floor = kAgainstDelay * mode.law * t_d;
  const double worth = step_between(found.ratio / wanted, kWorthFrom, kWorthFull);
  const double reached = step_between(found.ratio / wanted, kNearly, 1.0);
  const double scaled = (1.0 + (above - 1.0) * reached) * found.D;
  const double D = std::min(std::max(rigid + worth * (scaled - rigid), floor), most);
  return {D, D == found.D ? found.ratio : way.ratio_at(D)};
}

double motor_share(const ElasticMode& m, double D, double t_d) noexcept {
  constexpr int kRounds = 30;
  const double k = m.law;
  double w = std::sqrt((m.spring + (m.at_link ? 0.0 : k)) / m.rotor);
  const double slowest = std::sqrt(m.spring / m.rotor);
  for (int i = 0; i < kRounds; ++i) {
    const double x = std::min(w * t_d, 3.0);
    const double square =
        (m.spring + (m.at_link ? 0.0 : k * std::cos(x)) + D * w * std::sin(x)) / m.rotor;
    w = 0.5 * (w + std::max(std::sqrt(std::max(square, 0.0)), slowest));
  }
  const double x = w * t_d;
  const double left = m.damper + D * std::cos(x);
  if (!(left > 0.0)) return std::numeric_limits<double>::infinity();
  return k * std::sin(x) / (w * left);
}

}  // namespace limber::controller
