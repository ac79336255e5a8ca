// From a message to gains.
#pragma once

#include <limber/compliance_gains_t.hpp>

#include "controller/kinds/gains.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// The gains of robot.yaml. Throws ConfigError if there are not as many as joints.
Gains default_gains(const Robot& robot, LawRows rows);

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
