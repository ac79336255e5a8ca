// Where an activity or a law begins.
#pragma once

#include "controller/cycle_parts.h"
#include "controller/kinds/activity.h"

namespace limber::controller {

/// Whatever begins starts where the arm is, and its first torque is the one present, which fades
/// over; the model is evaluated once more, at the point where the new law receives the arm. All
/// members may be called in the cycle.
class LawSwitch {
 public:
  /// `parts` outlive this.
  explicit LawSwitch(CycleParts* parts) noexcept : parts_(*parts) {}

  Activity activity() const noexcept { return activity_; }
  /// Nothing happens where the activity is the last one already.
  void enter(Activity activity) noexcept;
  void stand_by() noexcept { activity_ = Activity::kStandby; }
  /// The law of Activity::kLaw from now on, index in the registry; begins now if that is the
  /// activity.
  void select(int law, Activity activity) noexcept;

 private:
  void start_law(GoalType from, bool from_here) noexcept;

  CycleParts& parts_;
  Activity activity_ = Activity::kStandby;
};

}  // namespace limber::controller
