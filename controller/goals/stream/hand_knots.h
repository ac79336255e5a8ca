// The hand's widths of a target stream, each acting at its knot's time.
#pragma once

#include <array>
#include <cstdint>
#include <limber/hand_goal_t.hpp>
#include <limber/target_stream_t.hpp>
#include <optional>

namespace limber::controller {

/// They are not faded: the hand has a speed of its own. All members may be called in the cycle.
class HandKnots {
 public:
  static constexpr int kMost = 256;

  /// As KnotPath::replace(), of a message that TargetStream has taken, which bounds how many wait;
  /// beyond that the oldest go.
  void take(const target_stream_t& message, std::int64_t now_ns) noexcept;
  /// The goal of the newest knot whose time has come since the last call; nothing if none has.
  std::optional<hand_goal_t> due(std::int64_t now_ns) noexcept;
  /// None waits any more.
  void end() noexcept { count_ = 0; }

 private:
  struct Width {
    std::int64_t time_ns;
    float width_m;
    float force_N;
  };
  Width& knot(int i) noexcept { return knots_[static_cast<std::size_t>((first_ + i) % kMost)]; }

  std::array<Width, kMost> knots_{};
  int first_ = 0;
  int count_ = 0;
};

}  // namespace limber::controller
