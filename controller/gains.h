// How soft the arm shall be and by which law's options, checked.
#pragma once

#include <limber/compliance_gains_t.hpp>

#include "common/types.h"
#include "controller/law_settings.h"
#include "robots/robot.h"

namespace limber::controller {

/// Six-by-six matrices are [linear; angular]. A message gives joint matrices by their diagonals.
struct Gains {
  explicit Gains(int joints)
      : K_q(MatrixJ::Zero(joints, joints)),
        D_q(K_q),
        M_q(K_q),
        K_acc(K_q),
        D_acc(K_q),
        K_null(K_q),
        D_null(K_q) {}

  Matrix6 K_x = Matrix6::Zero();  ///< N/m, N/rad, N m/rad; symmetric, positive semidefinite
  double damping_ratio = 0.7;     ///< of every Cartesian mode
  Matrix6 D_x = Matrix6::Zero();  ///< used if given: N s/m, N s/rad, N m s/rad; symmetric
  Matrix6 M_x = Matrix6::Zero();  ///< kg, kg m, kg m^2; symmetric; zero: the arm's own
  MatrixJ K_q;                    ///< N m/rad
  double joint_damping_ratio = 0.7;
  MatrixJ D_q;     ///< used if given: N m s/rad
  MatrixJ M_q;     ///< kg m^2; zero: the arm's own diagonal
  MatrixJ K_acc;   ///< 1/s^2
  MatrixJ D_acc;   ///< 1/s
  MatrixJ K_null;  ///< N m/rad
  MatrixJ D_null;  ///< N m s/rad
  LawSettings settings;
};

/// The gains of robot.yaml. Throws ConfigError if there are not as many as joints.
Gains default_gains(const Robot& robot);

/// nullptr if the message's numbers are all allowed, else what is wrong. May be called in the
/// cycle.
const char* refuse_gains(const compliance_gains_t& message, int joints) noexcept;

/// The gains of a message that refuse_gains() found nothing wrong with. In the cycle.
void read_gains(const compliance_gains_t& message, Gains* gains) noexcept;

/// K_x, D_x and M_x turned from the axes they are given in to base axes: T K T^T,
/// T = blkdiag(R_BD, R_BD) for GainFrame::kGoal. In the cycle.
void turn_to_base(const Eigen::Matrix3d& R_BD, Gains* gains) noexcept;

/// Moves from one set of gains to another along a cosine, so that no torque jumps. What is ramped
/// are springs and dampers: mixtures of allowed ones are allowed. May be called in the cycle.
class GainRamp {
 public:
  explicit GainRamp(const Gains& gains) : now_(gains), from_(gains), to_(gains) {}

  /// From the present gains to `gains` in `duration_s`, at least kShortestRamp_s. At once, since a
  /// mixture would not be what either asks for: the settings; M_x and M_q, which divide and pass
  /// through zero on the way; D_x and D_q where damping was designed before.
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
