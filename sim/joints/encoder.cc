#include "sim/joints/encoder.h"

#include <algorithm>
#include <cmath>

#include "sim/joints/noise.h"

namespace limber::sim {

Encoder::Encoder(const EncoderErrors& errors, unsigned seed)
    : errors_(errors), noise_key_(static_cast<std::uint64_t>(seed) * 0xA0761D6478BD642FU) {}

void Encoder::update(const AngleReading& now, double h) noexcept {
  if (!errors_.any()) return;
  ++noise_key_;
  if (!started_) {
    started_ = true;
    delay_ = std::min(static_cast<std::size_t>(std::lround(errors_.delay_s / h)), kMaxDelay);
    past_.fill({now.angle, 0.0});
  }
  newest_ = (newest_ + 1) % past_.size();
  past_[newest_] = now;
}

AngleReading Encoder::reading(const AngleReading& now) const noexcept {
  if (!errors_.any()) return now;
  const AngleReading seen =
      started_ ? past_[(newest_ + past_.size() - delay_) % past_.size()] : now;
  const double noise = errors_.noise_rad > 0.0 ? errors_.noise_rad * gaussian(noise_key_) : 0.0;
  const double off_centre = errors_.eccentricity_rad;
  return {seen.angle + errors_.bias_rad + off_centre * std::sin(seen.angle) + noise,
          seen.rate * (1.0 + off_centre * std::cos(seen.angle))};
}

}  // namespace limber::sim
