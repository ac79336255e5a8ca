// What an encoder that is not perfect adds to an angle; its counts are the drive's business.
//
//   reading = a + bias + eccentricity sin(a) + noise,   a: the angle delay_s ago
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "robots/loader/joint_chain.h"

namespace limber::sim {

/// An angle and its rate, rad and rad/s (m, m/s).
struct AngleReading {
  double angle = 0.0;
  double rate = 0.0;
};

/// A value; after construction every member is allowed in the cycle. Drives with a position loop of
/// their own close it on the true angle: errors are in what they report.
class Encoder {
 public:
  /// Longest delay, in updates; a longer one is cut down to it.
  static constexpr std::size_t kMaxDelay = 63;

  Encoder() = default;  ///< perfect
  /// Encoders with other seeds have other noise.
  Encoder(const EncoderErrors& errors, unsigned seed);

  /// Where it is after another h > 0 seconds; h is the same in every call. The first update finds
  /// the encoder at rest there.
  void update(const AngleReading& now, double h) noexcept;
  /// `now` with the errors; before the first update without delay.
  AngleReading reading(const AngleReading& now) const noexcept;

 private:
  EncoderErrors errors_;
  std::uint64_t noise_key_ = 0;
  bool started_ = false;
  std::array<AngleReading, kMaxDelay + 1> past_{};  // ring
  std::size_t newest_ = 0;
  std::size_t delay_ = 0;  // updates
};

}  // namespace limber::sim
