// Is the arm carried by the torques that its description promises?
#pragma once

#include <algorithm>
#include <limber/joint_state_t.hpp>

#include "common/types.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// What acts on the arm besides its motors and its weight, a first-order estimate:
///
///   kMemory_s r' = M v' + C v + g - tau - r
///
/// An arm that has just been switched on carries a payload and its friction, and may still lie on
/// something that carries it. So r has to be that of a weight w >= 0 at the tip, r = w s with
/// s = J^T (direction of gravity), as well as it fits, or anything between zero and what carries
/// the joint's weight, g_i:
///
///   r_i - w s_i  within  [min(0, g_i), max(0, g_i)] +- m_i
///
/// or what keeps the joint from leaving its soft wall, which pushes with tau_wall,i: then the
/// bounds are widened to -tau_wall,i.
///
///   m_i = tau_friction + kModelShare abs(g_i) + w kOffset
///
/// A motor with the wrong sign or in another joint's place, a wrong zero, and a wrong mass show by
/// the weight that their joints carry, before a law has moved them far. A joint about a vertical
/// axis carries none: nothing is found there. Judged from kBegin_s to kEnd_s after the drives came
/// on, while the arm is held, and found if it holds for kLasting_s: a blow, or cycles that came
/// late, leave r in less.
///
/// A motor that makes s > 1 times the torque that it reports, by a wrong range or a firmware that
/// has changed it, looks like a stand: at rest it carries g with g / s, so r = (s - 1) tau. A stand
/// is left behind once a law moves the arm, or carries less when tau grows; this does not. So a
/// joint whose r was kSeems of its weight at least in HOLD, and tau_friction, is followed for
/// kFollowed_s then, from kBegin_s on, until for kLasting_s
///
///   abs(r - (r / tau in HOLD) tau) > kModelShare abs(r)
///
/// and is overdriven if before it has moved by kMovedBy, or tau has become kGrown times as much.
///
/// tau is the motor's, and M with its rotor; behind a torque sensor the sensor's, and M without it.
/// Arms with springs in joints without sensor are not watched.
class LoadWatch {
 public:
  static constexpr double kMemory_s = 0.02;
  static constexpr double kBegin_s = 0.125;
  static constexpr double kEnd_s = 1.0;
  static constexpr double kLasting_s = 0.03;
  static constexpr double kModelShare = 0.25;
  static constexpr double kOffset = 0.1;  ///< of the payload's centre from the tip, m
  static constexpr double kSeems = 0.4;
  static constexpr double kGrown = 1.4;
  static constexpr double kMovedBy = 0.03;  ///< rad (m for prismatic joints)
  static constexpr double kFollowed_s = 5.0;

  /// For set-up.
  explicit LoadWatch(const Robot& robot);

  // May be called in the cycle.

  /// The drives follow from the next state on.
  void begin() noexcept {
    time_s_ = followed_s_ = 0.0;
    answered_ = moved_ = false;
    ratio_.setZero();
    overdriven_ = -1;
  }
  /// A law moves the arm now: what supported it may be left behind or pushed against.
  void end() noexcept {
    time_s_ = kEnd_s;
    moved_ = true;
  }
  /// The model at a state: N m, kg m^2, and the tip's Jacobian.
  struct Model {
    const VectorJ& gravity;
    const VectorJ& Cv;
    const MatrixJ& M;  ///< of the links
    const VectorJ& B;  ///< of the rotors
    const Matrix6J& J;
    const VectorJ& walls;  ///< of the controller's soft walls, N m
  };
  /// Once a cycle with drives that follow: the joint that carries what it should not, -1: none.
  /// `dt_s`: since the last call.
  int wrong(const joint_state_t& state, const Model& model, double dt_s) noexcept;
  /// After wrong(): the joint whose motor makes a multiple of the torque that it reports, -1: none.
  int overdriven() const noexcept { return overdriven_; }
  /// Once a cycle otherwise: r fades.
  void relax(double dt_s) noexcept {
    r_ *= std::max(0.0, 1.0 - dt_s / kMemory_s);
    follow(overdriven_ < 0 ? r_ : held_r_, dt_s);
  }
  /// The torque that carries the arm, within the joints' limits, N m: what the drives are to hold
  /// with when the controller gives up. It is g - r, but r counts no faster than the joints' torque
  /// may change, as the gate refuses steps of it. After the watch it is g, but for a joint that is
  /// overdriven.
  VectorJ carrying(const VectorJ& gravity) const noexcept {
    return (gravity - carried_).cwiseMax(-limit_Nm_).cwiseMin(limit_Nm_);
  }
  /// N m.
  const VectorJ& residual() const noexcept { return r_; }

 private:
  bool follows(const joint_state_t& state, double dt_s) noexcept;
  void observe(const joint_state_t& state, const Model& model, double dt_s) noexcept;
  int judge(const Model& model) const noexcept;
  void note_supported(const joint_state_t& state, const Model& model) noexcept;
  void judge_supported(const joint_state_t& state, double dt_s) noexcept;
  void follow(const VectorJ& r, double dt_s) noexcept {
    const VectorJ most = rate_Nm_per_s_ * dt_s;
    carried_ += (r - carried_).cwiseMax(-most).cwiseMin(most);
  }

  bool watched_;
  VectorJ friction_Nm_;
  VectorJ limit_Nm_;
  VectorJ rate_Nm_per_s_;
  VectorJ by_motor_;        ///< 1: the motor's torque counts, 0: the sensor's
  Eigen::Vector3d down_;    ///< of length one, or zero without gravity
  double time_s_ = kEnd_s;  ///< since begin()
  double wrong_s_ = 0.0;    ///< without a break
  bool answered_ = false;   ///< every joint, in the state before
  VectorJ v_;               ///< of the state before
  VectorJ r_;
  VectorJ carried_;  ///< of r, by what is not the motors, in carrying()
  VectorJ tau_;      ///< as late as r
  // Of joints that seemed to be supported in HOLD, r / tau there, else 0; and what
  // was there.
  VectorJ ratio_;
  VectorJ held_tau_;
  VectorJ held_r_;
  VectorJ held_q_;
  bool moved_ = false;       ///< by a law
  double followed_s_ = 0.0;  ///< since then
  VectorJ unlike_s_;         ///< r / tau is another, without a break
  int overdriven_ = -1;
};

}  // namespace limber::controller
