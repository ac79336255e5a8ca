// Is the arm carried by the torques that its description promises?
#pragma once

#include <algorithm>
#include <limber/joint_state_t.hpp>
#include <optional>
#include <vector>

#include "common/types.h"
#include "controller/watches/scale_watch.h"
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
/// A joint that seems to be carried is followed for kFollowed_s once a law moves the arm, from
/// kBegin_s on: a motor that makes more than it reports looks the same in HOLD (ScaleWatch).
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
  static constexpr double kFollowed_s = 5.0;

  /// For set-up.
  explicit LoadWatch(const Robot& robot);

  // May be called in the cycle.

  /// The drives follow from the next state on.
  void begin() noexcept {
    time_s_ = 0.0;
    law_s_.reset();
    answered_ = false;
    for (ScaleWatch& joint : scales_) joint.forget();
    overdriven_ = -1;
  }
  /// A law moves the arm now: what supported it may be left behind or pushed against.
  void end() noexcept {
    time_s_ = kEnd_s;
    if (!law_s_) law_s_ = 0.0;
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
    follow(r_, dt_s);
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
  bool follows_scales() const noexcept;
  ScaleWatch::Seen seen(const joint_state_t& state, Eigen::Index joint) const noexcept {
    return {r_[joint], tau_[joint], state.q[joint]};
  }
  void hold_scales(const joint_state_t& state, const Model& model) noexcept;
  void judge_scales(const joint_state_t& state, double dt_s) noexcept;
  void follow(const VectorJ& r, double dt_s) noexcept {
    const VectorJ most = rate_Nm_per_s_ * dt_s;
    const VectorJ& target = overdriven_ < 0 ? r : held_r_;
    carried_ += (target - carried_).cwiseMax(-most).cwiseMin(most);
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
  VectorJ carried_;                 ///< of r, by what is not the motors, in carrying()
  VectorJ tau_;                     ///< as late as r
  VectorJ held_r_;                  ///< in HOLD
  std::vector<ScaleWatch> scales_;  ///< by joint
  std::optional<double> law_s_;     ///< that a law moves the arm, followed
  int overdriven_ = -1;
};

}  // namespace limber::controller
