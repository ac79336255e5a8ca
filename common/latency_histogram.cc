#include "common/latency_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace limber {

void LatencyHistogram::add(std::int64_t duration_ns) noexcept {
  const std::int64_t value = std::max<std::int64_t>(duration_ns, 0);
  max_ = std::max(max_, value);
  ++count_;
  int bin = static_cast<int>(value);
  if (value >= kPerOctave) {
    const int octave = std::bit_width(static_cast<std::uint64_t>(value)) - 5;  // 0 for 16..31
    bin = (octave + 1) * kPerOctave + static_cast<int>((value >> octave) - kPerOctave);
  }
  ++bins_[std::min<std::size_t>(static_cast<std::size_t>(bin), bins_.size() - 1)];
}

std::int64_t LatencyHistogram::quantile(double q) const noexcept {
  if (count_ == 0) return 0;
  const auto wanted = static_cast<std::int64_t>(std::ceil(q * static_cast<double>(count_)));
  std::int64_t seen = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    seen += bins_[bin];
    if (seen < std::max<std::int64_t>(wanted, 1)) continue;
    const auto index = static_cast<std::int64_t>(bin);
    if (index < kPerOctave) return std::min(index, max_);
    const std::int64_t octave = index / kPerOctave - 1;
    return std::min(((index % kPerOctave + kPerOctave + 1) << octave) - 1, max_);
  }
  return max_;
}

}  // namespace limber
