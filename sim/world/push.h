// Hands on the arm: wrenches on links that rise, stay and fall by themselves.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "common/types.h"

namespace limber::sim {

/// One push. It rises over `ramp` with a cosine edge from whatever the push it replaces was
/// exerting, and falls to zero at the end of `duration`.
struct Push {
  int id = 0;
  int link = 0;  ///< index into ArmModel::links
  Vector6 wrench = Vector6::Zero();
  Vector6 from = Vector6::Zero();
  std::int64_t start_ns = 0;
  std::int64_t ramp_ns = 0;
  std::int64_t duration_ns = 0;

  /// Wrench at the link's origin, base axes, at simulated time t; zero outside the push.
  Vector6 at(std::int64_t t_ns) const noexcept;
  bool over(std::int64_t t_ns) const noexcept { return t_ns >= start_ns + duration_ns; }
};

/// Pushes at work: fixed slots, no allocation.
class PushSlots {
 public:
  static constexpr int kSlots = 8;

  /// A push with an id that is at work replaces it if it is on the same link, without a jump; on
  /// another link it starts anew. False if all slots are taken.
  bool add(Push push, std::int64_t now_ns) noexcept;
  void clear() noexcept { count_ = 0; }
  /// Frees the slots of pushes that are over.
  void drop_finished(std::int64_t now_ns) noexcept;

  int count() const noexcept { return count_; }
  const Push& operator[](int i) const noexcept { return slots_[i]; }

 private:
  std::array<Push, kSlots> slots_;
  int count_ = 0;
};

}  // namespace limber::sim
