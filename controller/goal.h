// Where the arm shall be and how it shall move there, at one instant.
#pragma once

#include "common/types.h"
#include "controller/pose.h"

namespace limber::controller {

/// What a law follows: a law for the tip has X_BD and its rates, a law for the joints has those and
/// q_d with its rates, which belong together. Twists and accelerations as in ArmTerms: base axes,
/// tip origin, linear first.
struct Goal {
  explicit Goal(int joints)
      : q_d(VectorJ::Zero(joints)),
        v_d(VectorJ::Zero(joints)),
        a_d(VectorJ::Zero(joints)),
        j_d(VectorJ::Zero(joints)),
        s_d(VectorJ::Zero(joints)),
        q_null(VectorJ::Zero(joints)) {}

  Pose X_BD;
  Vector6 V_BD = Vector6::Zero();
  Vector6 A_BD = Vector6::Zero();
  Vector6 F_ff = Vector6::Zero();  ///< wrench the arm shall exert besides, N and N m
  VectorJ q_d;
  VectorJ v_d;
  VectorJ a_d;
  VectorJ j_d;  ///< da_d/dt and its rate along a smooth motion, zero along others
  VectorJ s_d;
  VectorJ q_null;  ///< null-space posture
};

}  // namespace limber::controller
