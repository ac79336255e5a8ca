// How soft the arm shall be and by which law's options, checked.
#pragma once

#include <limber/compliance_gains_t.hpp>

#include "common/types.h"
#include "controller/gains/law_parameters.h"
#include "controller/gains/law_settings.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Six-by-six matrices are [linear; angular]. A message gives joint matrices by their diagonals.
struct Gains {
  /// Zero stiffness, the table's default settings.
  explicit Gains(int joints);

  Matrix6 K_x = Matrix6::Zero();  ///< N/m, N/rad, N m/rad; symmetric, positive semidefinite
  double damping_ratio = 0.7;     ///< of every Cartesian mode
  Matrix6 D_x = Matrix6::Zero();  ///< used if given: N s/m, N s/rad, N m s/rad; symmetric
  Matrix6 M_x = Matrix6::Zero();  ///< kg, kg m, kg m^2; symmetric; zero: the arm's own
  MatrixJ K_q;                    ///< N m/rad
  double joint_damping_ratio = 0.7;
  MatrixJ D_q;     ///< used if given: N m s/rad
  MatrixJ K_null;  ///< N m/rad
  MatrixJ D_null;  ///< N m s/rad
  LawSettings settings;
  LawParameters parameters;  ///< of single laws
};

/// The settings with which nobody has chosen anything; also those of HOLD.
const LawSettings& default_settings() noexcept;

/// The gains of robot.yaml. Throws ConfigError if there are not as many as joints.
Gains default_gains(const Robot& robot);

/// The gains of merged fields (lcmtypes/gains_merge.h) that GainsCheck found nothing wrong with.
/// In the cycle.
void read_gains(const compliance_gains_t& fields, Gains* gains) noexcept;

/// The parameters of single laws that a checked request lists; the others stay, with SCOPE_ALL they
/// take their default. In the cycle.
void read_parameters(const compliance_gains_t& request, LawParameters* parameters,
                     int joints) noexcept;

/// K_x, D_x and M_x turned from the axes they are given in to base axes: T K T^T,
/// T = blkdiag(R_BD, R_BD) for GainFrame::kGoal. In the cycle.
void turn_to_base(const Eigen::Matrix3d& R_BD, Gains* gains) noexcept;

}  // namespace limber::controller
