// How soft the arm shall be and by which law's options, checked. Read from a message by
// gains/read_gains.h.
#pragma once

#include "common/types.h"
#include "controller/kinds/law_parameters.h"
#include "controller/kinds/law_settings.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// Six-by-six matrices are [linear; angular]. A message gives joint matrices by their diagonals.
struct Gains {
  /// Zero stiffness, the table's default settings; `rows`: the parameters of single laws, which
  /// outlive this.
  Gains(int joints, LawRows rows);

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

}  // namespace limber::controller
#pragma GCC visibility pop
