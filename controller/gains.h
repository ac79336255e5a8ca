// How soft the arm shall be, checked.
#pragma once

#include <limber/compliance_gains_t.hpp>

#include "common/types.h"
#include "controller/pose_error.h"
#include "robots/robot.h"

namespace limber::controller {

struct Gains {
  explicit Gains(int joints)
      : K_q(VectorJ::Zero(joints)), K_null(VectorJ::Zero(joints)), D_null(VectorJ::Zero(joints)) {}

  Orientation orientation = Orientation::kLog;
  Matrix6 K_x =
      Matrix6::Zero();         ///< N/m, N/rad, N m/rad; base axes; symmetric, positive semidefinite
  double damping_ratio = 0.7;  ///< of every Cartesian mode
  VectorJ K_q;                 ///< N m/rad
  double joint_damping_ratio = 0.7;
  VectorJ K_null;  ///< N m/rad
  VectorJ D_null;  ///< N m s/rad
};

/// The gains of robot.yaml. Throws ConfigError if there are not as many as joints.
Gains default_gains(const Robot& robot);

/// nullptr if the message's numbers are all allowed, else what is wrong. May be called in the
/// cycle.
const char* refuse_gains(const compliance_gains_t& message, int joints) noexcept;

/// The gains of a message that refuse_gains() found nothing wrong with.
void read_gains(const compliance_gains_t& message, Gains* gains) noexcept;

/// Moves from one set of gains to another along a cosine, so that no torque jumps. Mixtures of
/// allowed gains are allowed gains. May be called in the cycle.
class GainRamp {
 public:
  explicit GainRamp(const Gains& gains) : now_(gains), from_(gains), to_(gains) {}

  /// From the present gains to `gains` in `duration_s`, at least kShortestRamp_s. The orientation
  /// mode cannot be mixed: it changes at once.
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
