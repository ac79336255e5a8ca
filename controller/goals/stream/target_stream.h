// Target streams: knots with times, as a policy or a teleoperator sends them, become the goal.
#pragma once

#include <cstdint>
#include <limber/target_stream_t.hpp>

#include "controller/goals/goal_limits.h"
#include "controller/goals/stream/stream_motion.h"
#include "controller/kinds/law_entry.h"
#include "controller/kinds/refusal.h"

namespace limber::controller {

/// Of TARGET_STREAM since the start, as in CONTROLLER_STATUS.
struct StreamCounts {
  std::int32_t taken = 0, late = 0, stale = 0, refused = 0, starved = 0;
};

/// A message is taken whole or not at all. The goal at the tip and that of the joints (or, of a law
/// for the tip, its posture) each have a motion. All members may be called in the cycle.
class TargetStream {
 public:
  using Tip = TipSpace::Point;
  using Joints = JointSpace::Point;
  static constexpr std::int64_t kFarthest_ns = 5'000'000'000;  ///< ahead
  static constexpr std::int64_t kOldest_ns = 100'000'000;      ///< all knots before now: dropped
  static constexpr std::int64_t kStarved_ns = 100'000'000;     ///< without knots
  static constexpr double kClosestKnots_s = 0.001;
  static constexpr double kLongestDelay_s = 2.0;
  static constexpr double kSoftest = 0.05;
  static constexpr double kLargestTurn_rad = 2.0;  ///< from knot to knot
  static constexpr double kTwistLasts_s = 0.1;     ///< after its last knot

  explicit TargetStream(const Robot& robot);

  /// Nothing if a law of this kind may follow the message, else why not.
  Refusal check(const target_stream_t& message, GoalType type, std::int64_t now_ns) const noexcept;
  /// All knots lie so far back that the message is dropped.
  static bool stale(const target_stream_t& message, std::int64_t now_ns) noexcept {
    return end_ns(message, now_ns) + kOldest_ns < now_ns;
  }
  /// When a knot acts, and the last one, arm time.
  static std::int64_t knot_ns(const target_stream_t& message, int knot,
                              std::int64_t now_ns) noexcept;
  static std::int64_t end_ns(const target_stream_t& message, std::int64_t now_ns) noexcept;

  /// Joint positions, rad or m, of a checked message of that kind; beyond a joint's end: its end.
  VectorJ joints_of(const target_stream_t& message, int knot) const noexcept;

  /// Takes a checked message. `tip`, `joints`: where the goal is, for the motion that begins.
  /// `poses`: of KIND_JOINTS under a law for the tip the tip's pose at each knot; else null.
  Refusal take(const target_stream_t& message, const Pose* poses, const Tip& tip,
               const Joints& joints, std::int64_t now_ns) noexcept;
  void count_refused() noexcept { ++counts_.refused; }
  void count_stale() noexcept { ++counts_.stale; }

  void advance(std::int64_t now_ns, double dt_s) noexcept;
  void end() noexcept;

  bool leads_tip() const noexcept { return tip_.active(); }
  bool leads_joints() const noexcept { return joints_.active(); }
  const Tip& tip() const noexcept { return tip_.goal(); }
  const Joints& joints() const noexcept { return joints_.goal(); }

  /// controller_status_t STREAM_*.
  std::int8_t state() const noexcept;
  bool bounded() const noexcept { return clipped_ || tip_.bounded() || joints_.bounded(); }
  double delay_s() const noexcept { return delay_s_; }
  double margin_s() const noexcept { return margin_s_; }
  const StreamCounts& counts() const noexcept { return counts_; }

 private:
  bool take_joints(const target_stream_t& message, std::int64_t now_ns) noexcept;
  bool take_tip(const target_stream_t& message, const Pose* poses, std::int64_t now_ns) noexcept;
  bool take_twist(const target_stream_t& message, std::int64_t now_ns) noexcept;

  VectorJ position_min_, position_max_;
  StreamMotion<TipSpace> tip_;
  StreamMotion<JointSpace> joints_;
  std::int64_t cycle_ns_ = 0;  ///< arm time of the last cycle
  std::int64_t last_ns_ = 0;   ///< when the last knot acts
  bool starved_ = false;
  bool clipped_ = false;
  double delay_s_ = 0.0;
  double margin_s_ = 0.0;
  StreamCounts counts_;
};

}  // namespace limber::controller
