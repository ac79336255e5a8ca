// Sine and cosine of all joints at once: Taylor's series about the nearest quarter turn, which is
// no more than pi / 4 away.
#pragma once

#include "dynamics/joint_rows.h"

namespace limber::dynamics::LIMBER_LEVEL {

template <int N>
struct RowSines {
  Row<N> sine, cosine;
};

/// c0 + x (c1 + x (c2 + ...)).
template <int N, typename... More>
[[gnu::always_inline]] inline Row<N> series(const Row<N>& x, double first, More... more) noexcept {
  if constexpr (sizeof...(more) == 0)
    return {first + typename Row<N>::Lanes{}};
  else
    return first + x * series(x, more...);
}

/// Of angles in rad. Off by less than 3e-16 up to a million rad; of no meaning beyond 1e15. In the
/// cycle.
template <int N>
[[gnu::always_inline]] inline RowSines<N> sines(const Row<N>& angle) noexcept {
  if constexpr (!kOneRegister<N>) {
    const auto low = sines(angle.low);
    const auto high = sines(angle.high);
    return {{low.sine, high.sine}, {low.cosine, high.cosine}};
  } else {
    // The last bits of x + 1.5 * 2^52 are those of x rounded to a whole number.
    constexpr double kRounds = 6755399441055744.0;
    constexpr double kQuartersOfOneRad = 0.63661977236758134308;
    // pi / 2 in three parts; the first two times a whole number of 20 bits are exact.
    constexpr double kQuarter[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};

    using Lanes = typename Row<N>::Lanes;
    using Whole = typename Row<N>::Whole;
    const Row<N> rounded = kRounds + kQuartersOfOneRad * angle;
    const Whole quarter = reinterpret_cast<Whole>(rounded.lanes);
    const Row<N> quarters = -kRounds + rounded;
    const Row<N> x =
        ((angle - kQuarter[0] * quarters) - kQuarter[1] * quarters) - kQuarter[2] * quarters;
    const Row<N> xx = x * x;
    const Row<N> s = x + x * xx *
                             series(xx, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880,
                                    -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368000);
    const Row<N> c =
        1.0 + xx * series(xx, -1.0 / 2, 1.0 / 24, -1.0 / 720, 1.0 / 40320, -1.0 / 3628800,
                          1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000);
    // In an odd quarter they change places; what turned by half is negative.
    const Whole odd = -(quarter & 1);
    const Whole swap = odd & (reinterpret_cast<Whole>(s.lanes) ^ reinterpret_cast<Whole>(c.lanes));
    const Whole sine = reinterpret_cast<Whole>(s.lanes) ^ swap ^ ((quarter & 2) << 62);
    const Whole cosine = reinterpret_cast<Whole>(c.lanes) ^ swap ^ (((quarter + 1) & 2) << 62);
    return {{reinterpret_cast<Lanes>(sine)}, {reinterpret_cast<Lanes>(cosine)}};
  }
}

}  // namespace limber::dynamics::LIMBER_LEVEL
