// The setpoint of a position loop on its way to its goal, as drives with limits of speed and
// acceleration let it go.
#pragma once

#include <limits>

namespace limber::sim {

/// Angles in any unit, that of the loop. NaN: none. Allowed in the cycle throughout.
struct ProfileGoal {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double position = kNone;  ///< of now, moving on with the velocity; none: the velocity alone
  double velocity = 0.0;
  double velocity_limit = kNone;
  double acceleration_limit = kNone;
};

class SetpointProfile {
 public:
  /// Puts the setpoint there, with no goal.
  void start(double position, double velocity) noexcept;
  /// Without limits the setpoint is at the goal at once, else it begins to move from where it is.
  void aim(const ProfileGoal& goal) noexcept;
  void advance(double seconds) noexcept;
  /// Moves the setpoint into a range that it must not leave; NaN: no end. With limits it goes on
  /// from there.
  void keep_within(double least, double greatest) noexcept;

  double position() const noexcept { return position_; }
  double velocity() const noexcept { return velocity_; }
  /// Whether the setpoint has reached its goal; it goes on with the goal's velocity.
  bool complete() const noexcept { return complete_; }

 private:
  void change_speed(double seconds) noexcept;
  void approach(double seconds) noexcept;
  double within_limit(double velocity) const noexcept;

  ProfileGoal goal_;
  double position_ = 0.0;
  double velocity_ = 0.0;
  bool complete_ = true;
};

}  // namespace limber::sim
