// Gives the link the stiffness asked for, from the motor's position alone.
#pragma once

#include "controller/model/arm_terms.h"
#include "controller/model/pose_error.h"
#include "controller/model/spring_limit.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// Static laws of the link: l(q) is the torque it shall see at rest.
struct TipSpring {  ///< l = g + J^T (F_ff - h A^T K_x e), h see spring_limit.h
  Pose X_BD;
  Matrix6 K_x;
  Orientation orientation = Orientation::kLog;
  Vector6 F_ff = Vector6::Zero();
  SpringLimit limit{Matrix6::Zero(), 0.0, 0.0};  ///< none
};
struct JointSpring {  ///< l = g - K_d (q - q_d)
  VectorJ q_d;
  MatrixJ K_d;
};

/// q_bar: where the link is at rest while the motor is at theta and applies l (Ott,
/// Albu-Schaeffer, Kugi, Hirzinger 2008; Albu-Schaeffer, Ott, Hirzinger 2007):
///   K_J (theta - q_bar) = l(q_bar),   u = l(q_bar).
/// The motor torque u, damping added by the caller, depends on theta alone and is the gradient of a
/// potential, so the loop stays passive; at rest the link meets exactly l. Solved by the fixpoint
/// q_bar <- theta - K_J^-1 l(q_bar), which contracts by |K_J^-1 dl/dq|, from the last solution on;
/// where that does not contract, by Newton steps with a differenced dl/dq. There is no solution to
/// use where K_J + dl/dq is not positive definite: a link cannot be made stiffer than its spring
/// (K_d < K_J + dg/dq). Close to that a turn of the motor would move q_bar without bounds: at least
/// kLeastShare K_J has to be left, at each Newton step.
class QbarSolver {
 public:
  static constexpr double kLeastShare = 0.05;

  struct Options {
    double tolerance = 1e-12;  ///< of q_bar, rad
    int max_iterations = 100;  ///< three or four are usual when warm
    int max_newton_steps = 100;
    bool newton = true;  ///< without: give up where the fixpoint does not contract
  };

  /// K_J: joint springs, n, > 0, N m/rad. The model must outlive the solver.
  QbarSolver(ArmModel* model, const VectorJ& K_J, const Options& options);
  QbarSolver(ArmModel* model, const VectorJ& K_J) : QbarSolver(model, K_J, Options()) {}

  /// From now on: other springs, whether l has gravity's part, and a further torque that does not
  /// change with q. n each. May be called in the cycle.
  void set(const VectorJ& K_J, bool gravity, const VectorJ& tau_constant) noexcept {
    K_J_ = K_J;
    gravity_ = gravity;
    tau_constant_ = tau_constant;
  }

  /// theta: motor position behind the gear, n. True: solved. False: q_bar() is theta and u() is
  /// l(theta), the law without this correction, which is softer; a theta that
  /// is not finite leaves both as they were. In the cycle.
  bool solve(const VectorJ& theta, const TipSpring& spring) noexcept;
  bool solve(const VectorJ& theta, const JointSpring& spring) noexcept;
  /// Forgets the last solution. May be called in the cycle.
  void reset() noexcept { warm_ = false; }

  const VectorJ& q_bar() const noexcept { return q_; }
  const VectorJ& u() const noexcept { return l_; }  ///< N m, without damping
  /// X_BT, J and g at q_bar; the damping torque is -J^T D_x J theta'.
  const ArmTerms& terms() const noexcept { return terms_; }
  int iterations() const noexcept { return iterations_; }

 private:
  VectorJ fixed_part() const noexcept {
    return gravity_ ? VectorJ(terms_.g + tau_constant_) : tau_constant_;
  }
  VectorJ law(const VectorJ& q, const TipSpring& spring) noexcept;
  VectorJ law(const VectorJ& q, const JointSpring& spring) noexcept;
  template <typename Spring>
  bool solve_for(const VectorJ& theta, const Spring& spring) noexcept;
  template <typename Spring>
  bool fixpoint(const VectorJ& theta, const Spring& spring) noexcept;
  template <typename Spring>
  bool newton(const VectorJ& theta, const Spring& spring) noexcept;
  bool stable(const MatrixJ& slope) const noexcept;
  template <typename Spring>
  MatrixJ tangent(const VectorJ& q, const Spring& spring) noexcept;

  ArmModel* model_;
  VectorJ K_J_;
  Options options_;
  bool gravity_ = true;
  VectorJ tau_constant_;
  ArmTerms terms_;
  VectorJ q_;
  VectorJ l_;
  int iterations_ = 0;
  bool warm_ = false;
};

}  // namespace limber::controller
#pragma GCC visibility pop
