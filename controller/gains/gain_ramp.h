// Moves from one set of gains to another.
#pragma once

#include "controller/kinds/gains.h"

namespace limber::controller {

/// Along a cosine, so that no torque jumps. What is ramped are springs and dampers: mixtures of
/// allowed ones are allowed. May be called in the cycle.
class GainRamp {
 public:
  explicit GainRamp(const Gains& gains) : now_(gains), from_(gains), to_(gains) {}

  /// From the present gains to `gains` in `duration_s`, at least kShortestRamp_s. At once, since a
  /// mixture would not be what either stands for: the settings; M_x and parameters of laws that do
  /// not ramp, which divide or pass through zero on the way; D_x and D_q where damping was designed
  /// before.
  void start(const Gains& gains, double duration_s) noexcept;
  void advance(double dt_s) noexcept;
  const Gains& now() const noexcept { return now_; }
  bool moving() const noexcept { return elapsed_s_ < duration_s_; }

  static constexpr double kShortestRamp_s = 0.1;

 private:
  Gains now_;
  Gains from_;
  Gains to_;
  double elapsed_s_ = 0.0;
  double duration_s_ = 0.0;
};

}  // namespace limber::controller
