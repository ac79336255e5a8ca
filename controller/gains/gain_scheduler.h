// The gains of each cycle, from those that were requested.
#pragma once

#include <algorithm>

#include "controller/elastic/arm_view.h"
#include "controller/gains/energy_tank.h"
#include "controller/gains/gain_ramp.h"
#include "controller/impedance/springs_check.h"
#include "controller/kinds/law_entry.h"

namespace limber::controller {

/// Moves the gains along their ramp, turns them to base axes, reduces them to what the joints'
/// springs allow, and draws the energy of a stiffer K_x from the tank. All members may be called in
/// the cycle.
class GainScheduler {
 public:
  /// Throws ConfigError where robot.yaml's K_q is stiffer than 0.9 times a joint's spring.
  GainScheduler(const Robot& robot, const JointSprings& springs, LawRows rows);

  /// The gains the arm is on the way to; their settings are already chosen.
  const Gains& target() const noexcept { return ramp_.now(); }
  const LawSettings& settings() const noexcept { return ramp_.now().settings; }
  bool moving() const noexcept { return ramp_.moving() || scale_ != scale_end_; }
  /// Takes checked gains. True if something changes at once, so that the torque has to be blended.
  bool start(const Gains& requested, double ramp_s) noexcept;

  /// Multiplies the stiffness of laws, not that of HOLD, 0..1: at most 2 a second away from what it
  /// is, until another or start().
  void scale_stiffness(double scale) noexcept { scale_end_ = scale; }

  /// The position at which this law receives the arm, `holding` by the default settings.
  PositionFeedback position(const LawEntry& law, bool holding, const ArmView& arm) const noexcept;

  /// The gains of this cycle, in base axes.
  const Gains& effective() const noexcept { return effective_; }
  /// K_x is less than requested: the joints' springs allow no more.
  bool reduced() const noexcept { return reduced_; }
  /// Moves the ramp along.
  void advance(double dt_s) noexcept {
    changed_ = changed_ || ramp_.moving();
    ramp_.advance(dt_s);
    const double most = kScaleRate_per_s * dt_s;
    scale_ += std::clamp(scale_end_ - scale_, -most, most);
  }
  /// Makes the effective gains for this goal and law, `holding` with the default settings.
  const Gains& update(const Goal& goal, const LawEntry& law, bool holding, const ArmView& arm,
                      double period_s) noexcept;

  /// Energy per time that the law's damper takes out, W; fills the tank once, in the next update.
  void set_dissipated(double power_W) noexcept { last_dissipated_W_ = power_W; }

  double tank_energy_J() const noexcept { return settings().tank_J > 0.0 ? tank_.energy_J() : 0.0; }
  /// Requested gains in base axes, as the springs at rest allow them: what they would be now.
  Gains here(const Gains& gains, const LawEntry& law, const Goal& goal,
             const ArmView& arm) const noexcept;
  /// nullptr if the links can be given these gains with this law, at this goal, else why not. The
  /// text lasts until the next call.
  const char* check_springs(const Gains& gains, const LawEntry& law, const Goal& goal,
                            const ArmView& arm) noexcept;

 private:
  static constexpr double kScaleRate_per_s = 2.0;

  void take_ramped() noexcept;
  void reduce_to_springs(const LawEntry& law, bool holding, const ArmView& arm) noexcept;
  void draw_from_tank(const Goal& goal, const ArmView& arm, double period_s) noexcept;

  SpringsCheck springs_check_;
  GainRamp ramp_;
  Gains effective_;
  bool changed_ = false;  // the ramp's, since effective_ took them
  EnergyTank tank_;
  double last_dissipated_W_ = 0.0;
  bool reduced_ = false;
  double scale_ = 1.0;
  double scale_end_ = 1.0;
};

}  // namespace limber::controller
