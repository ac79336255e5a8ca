// Which TICK has come on which bus.
#pragma once

#include <array>
#include <cstdint>

#include "common/joints.h"

namespace limber::sim {

/// A period starts when all buses carry the same new number. Allowed in the cycle throughout.
class TickCount {
 public:
  enum class Verdict : std::uint8_t {
    kWait,      ///< other buses have yet to tick
    kAdvance,   ///< this was the last one
    kRepeated,  ///< the number has been done: answer it again
  };

  explicit TickCount(int buses) : buses_(buses) {}

  Verdict tick(int bus, std::int64_t number) noexcept {
    if (done_any_ && number == done_) return Verdict::kRepeated;
    waiting_[bus] = {true, number};
    for (int i = 0; i < buses_; ++i) {
      if (!waiting_[i].has || waiting_[i].number != number) return Verdict::kWait;
    }
    falls_ = done_any_ && number < done_;
    done_any_ = true;
    done_ = number;
    waiting_ = {};
    return Verdict::kAdvance;
  }

  /// The last advance went to a smaller number than the one before: a new session.
  bool falls() const noexcept { return falls_; }

 private:
  struct Waiting {
    bool has = false;
    std::int64_t number = 0;
  };
  int buses_;
  std::array<Waiting, kMaxBuses> waiting_{};
  bool done_any_ = false;
  bool falls_ = false;
  std::int64_t done_ = 0;
};

}  // namespace limber::sim
