// Equilibrium of the virtual spring: pose, joint position or path, and feed-forward wrench.
#pragma once

#include "common/types.h"
#include "controller/kinds/pose.h"
#include "controller/kinds/smooth_motion.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// What a law follows: a law for the tip has X_BD and its rates, a law for the joints has those and
/// q_d with its rates, which belong together. Twists and accelerations as in ArmTerms: base axes,
/// tip origin, linear first.
struct Goal {
  explicit Goal(int joints)
      : q_d(VectorJ::Zero(joints)),
        v_d(VectorJ::Zero(joints)),
        a_d(VectorJ::Zero(joints)),
        q_null(VectorJ::Zero(joints)) {}

  Pose X_BD;
  Vector6 V_BD = Vector6::Zero();
  Vector6 A_BD = Vector6::Zero();
  Vector6 F_ff = Vector6::Zero();  ///< further wrench that the arm shall exert, N and N m
  VectorJ q_d;
  VectorJ v_d;
  VectorJ a_d;
  /// The motion that q_d is on, with its higher derivatives; nullptr unless it is a smooth one.
  const SmoothMotion<VectorJ>* smooth = nullptr;
  VectorJ q_null;  ///< null-space posture
};

}  // namespace limber::controller
#pragma GCC visibility pop
