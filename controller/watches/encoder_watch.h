// Has an encoder stopped counting while its joint moves?
#pragma once

#include <array>
#include <limber/joint_state_t.hpp>
#include <optional>
#include <vector>

#include "common/joints.h"
#include "common/types.h"
#include "controller/observers/momentum_observer.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// A reading that does not change by a single bit is normal at rest, also under torque: friction or
/// a wall holds the joint. It is not if the joint cannot have come to rest, or cannot have stayed
/// there. From the reading's last change on,
///
///   M_ii v' = load - balanced - tau_friction sign(v),   v(0) = v_0, the speed reported before
///   load = -r_i, what drives the joint by the momentum residual r, which knows the motion of the
///          other joints
///
/// where `balanced` is the part of load between zero and what it was then: that much a payload or a
/// wall held, and may still hold or have let go since. Friction may have helped it to hold, and may
/// hold the joint against it now: once the reading has stood for kRests_s, `balanced` goes
/// tau_friction further, less what a contact (below) may hold. A joint that truly stops is seen to
/// slow down, so that v_0 is next to nothing. Found is
///
///   - a sudden stop: v_0 is kSudden at least, and more than can be braked within a cycle by
///     friction and by something hard in the joint's way, which gives way by kGivesWay at the
///     torque limit and holds what drives the joint; at most by the torque limit. Springs stop
///     their rotor faster: for them always by the torque limit. So friction is left out, and
///     integral v dt >= kCoasted is enough, after kStood_s: a drive may read its encoder less often
///     than it answers. The jump of speed is in r, too: load is tau - g here;
///   - else integral v dt >= kExpected while the arm moves: another joint by kOthers at least, as
///     it does when this one swings unseen, and does not when the whole arm leans against
///     something. A wrist that hangs on to nothing may turn without moving another joint: not
///     found.
///
/// A hand or a wall may push joint k along and hold this joint to a single count meanwhile, while
/// its torque grows. Added to tau_friction is what such a contact may hold, the most over k of
///
///   kHeldShare push sqrt(M_ii / M_kk),   push > kFeltShare tau_friction_k
///
/// `push`: of the momentum residual r_k, and of its growth since, the lesser, along the way that k
/// has gone since, which is kOthers at least, no faster than kYields. The unseen swing of this
/// joint alone drives k by M_ki a_i, and M_ki^2 < M_kk M_ii: so that it is found before it has
/// gone kExpected / (1 - kHeldShare) = 0.1 rad. What r is kSettled_s after a reset hung on the arm
/// before: both of the push and of `balanced`.
///
/// A joint with a spring K, an encoder on either side of it and a torque sensor is found in a third
/// way, with no regard to friction or load: while neither reading changes by a bit, the spring is
/// stretched by the same angle, and its torque is the same. Found is a torque that has changed by
///
///   kStretchShare torque limit,   6 noise_Nm + resolution_Nm of the sensor,   4 counts of both
///   encoders times K: the most of these
///
/// for kStood_s, beginning kStood_s after the reading's last change. A change that takes longer
/// than kDrift_s is the sensor's own drift. Joints whose spring is not linear or that have two
/// motors are not watched so.
///
/// tau_friction is that of friction_bound.h. Cycles without the joint's answer do not count, nor do
/// those with a speed beyond kBelievable times a joint's limit: it is none (the driver's VELOCITY
/// finds it), but would move r, and with it every other joint.
class EncoderWatch {
 public:
  static constexpr double kExpected = 0.03;  ///< rad (m for prismatic joints)
  static constexpr double kCoasted = 0.01;   ///< likewise
  static constexpr double kStood_s = 0.01;
  static constexpr double kRests_s = 0.2;    ///< an unseen swing is mostly found sooner
  static constexpr double kSudden = 0.05;    ///< rad/s (m/s)
  static constexpr double kGivesWay = 1e-3;  ///< rad (m)
  static constexpr double kOthers = 0.01;    ///< likewise
  static constexpr double kYields = 2.5;     ///< rad/s (m/s)
  static constexpr double kFeltShare = 0.7;
  static constexpr double kHeldShare = 0.7;
  static constexpr double kStretchShare = 0.01;
  static constexpr double kDrift_s = 5.0;
  static constexpr double kSettled_s = 0.125;
  static constexpr double kBelievable = 2.0;

  /// For set-up.
  explicit EncoderWatch(const Robot& robot);

  // May be called in the cycle.

  /// Forgets what was seen.
  void reset() noexcept;
  struct Model {
    const VectorJ& gravity;  ///< torque that holds the arm's weight, N m
    const VectorJ& CTv;      ///< see MomentumObserver, N m
    const MatrixJ& M;        ///< of links and rotors, kg m^2
  };
  /// Once a cycle with drives that follow: the joint whose encoder has stopped, -1: none. `dt_s`:
  /// since the last call.
  int stopped(const joint_state_t& state, const Model& model, double dt_s) noexcept;

 private:
  /// Since a joint's reading changed last.
  struct Rest {
    bool continues(const joint_state_t& state, int i) const noexcept;
    bool arm_moved(const joint_state_t& state) const noexcept;
    /// Of the joint: by its torque and by its friction, rad/s^2.
    void move(double acceleration, double friction, double dt_s) noexcept;
    /// Whether the spring's torque contradicts the readings; after move().
    bool stretched(double sensor_Nm, double most_Nm, double dt_s) noexcept;

    double theta;  ///< the reading
    double q;
    double theta_dot;
    double v;
    double load_Nm;                         ///< then
    double spring_Nm;                       ///< of the sensor then, less what changes slowly
    std::array<double, kMaxJoints> thetas;  ///< of all joints then
    VectorJ residual;                       ///< likewise, N m
    bool sudden;
    double expected_speed;  ///< rad/s, from what was reported before on
    double stood_s = 0.0;
    double expected_angle = 0.0;  ///< since then, rad
    bool contradicts = false;     ///< the sensor did last time
    double contradicts_s = 0.0;   ///< in a row
  };
  struct Joint {
    bool stops_suddenly(double speed, double inertia, double load_Nm, double dt_s) const noexcept;

    double friction_Nm;
    double limit_Nm;
    double believable_speed;  ///< rad/s
    bool rigid;
    double stretch_Nm;  ///< of the spring's torque; infinite for joints that are not watched so
    std::optional<Rest> rest;
  };

  bool believable(const joint_state_t& state) const noexcept;
  /// What a contact may hold of joint i at most, N m.
  double held_Nm(const joint_state_t& state, int i, const MatrixJ& M) const noexcept;

  std::vector<Joint> joints_;
  MomentumObserver observer_;
  double observed_s_ = 0.0;
};

}  // namespace limber::controller
