// A user's torque on top of the law's, for some milliseconds.
#pragma once

#include <cstdint>
#include <limber/torque_overlay_t.hpp>

#include "common/types.h"
#include "controller/kinds/refusal.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Each message replaces the last. When its time is over the overlay is zero, and the torque fades
/// within the joints' rate limits. All members but the constructor may be called in the cycle.
class TorqueOverlay {
 public:
  static constexpr double kLongest_s = 0.05;
  static constexpr double kShareOfLimit = 1.0 / 3.0;  ///< of a joint's torque limit, at most

  explicit TorqueOverlay(const Robot& robot);

  /// Nothing: taken at arm time `now_ns`; else why not.
  Refusal set(const torque_overlay_t& message, std::int64_t now_ns) noexcept;
  /// n, N m.
  const VectorJ& torque(std::int64_t now_ns) noexcept;

  std::int32_t taken() const noexcept { return taken_; }
  std::int32_t expired() const noexcept { return expired_; }

 private:
  VectorJ most_, tau_;
  bool on_ = false;
  std::int64_t end_ns_ = 0;
  std::int32_t taken_ = 0;
  std::int32_t expired_ = 0;
};

}  // namespace limber::controller
