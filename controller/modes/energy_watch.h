// Does the arm move with energy that its torques have not given it?
#pragma once

#include <algorithm>
#include <limber/joint_state_t.hpp>
#include <limits>
#include <optional>

#include "common/joints.h"
#include "common/types.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// The kinetic energy of an arm changes by the work of its motors, of its weight and of the world:
///
///   T = v^T M v / 2,   dT = v^T (tau - g) dt + dW_world
///
/// W_world is what is left over. Friction takes from it; a hand, a falling load, a drive that makes
/// the opposite torque, or a model with the wrong weight give to it. A hand that pushes against a
/// spring gives much work to the spring but the arm hardly any speed. So what counts is the lesser
/// of the two: the arm moves with more than limit_J, and that much has come from outside within
/// about kMemory_s. What friction has taken before is no credit. It must be too much for kCycles in
/// a row: a velocity that is wrong for a moment is the driver's to find.
///
/// For arms with rigid joints: the springs of others store energy that is not in T.
class EnergyWatch {
 public:
  static constexpr double kMemory_s = 0.5;
  static constexpr int kCycles = 5;

  /// For set-up.
  explicit EnergyWatch(const Robot& robot)
      : limit_J_(std::ranges::all_of(robot.joints, &JointConfig::rigid)
                     ? robot.energy_limit_J
                     : std::numeric_limits<double>::infinity()) {}

  // May be called in the cycle.

  /// The drives do not follow: what the arm does now is not their work.
  void reset() noexcept {
    last_.reset();
    unexplained_J_ = 0.0;
  }
  /// Once a cycle with drives that follow: whether it is too much. `gravity` in N m, `M` with
  /// rotors, kg m^2; `dt_s`: since the last call. A value that is not finite is too much.
  bool exceeded(const joint_state_t& state, const VectorJ& gravity, const MatrixJ& M,
                double dt_s) noexcept {
    const auto n = gravity.size();
    const Eigen::Map<const VectorJ> v(state.v, n);
    const Eigen::Map<const VectorJ> tau(state.tau_applied, n);
    const double kinetic_J = 0.5 * v.dot(M * v);
    if (last_) {
      const double work_J = 0.5 * (v + last_->v).dot(tau - gravity) * dt_s;
      const double kept = std::max(0.0, 1.0 - dt_s / kMemory_s);
      unexplained_J_ = std::max(0.0, kept * unexplained_J_ + kinetic_J - last_->kinetic_J - work_J);
    }
    last_ = Cycle{v, kinetic_J};
    const bool within = std::min(kinetic_J, unexplained_J_) <= limit_J_;
    cycles_ = within ? 0 : cycles_ + 1;
    return cycles_ >= kCycles;
  }
  /// W_world as it counts, J; never negative.
  double unexplained_J() const noexcept { return unexplained_J_; }

 private:
  struct Cycle {
    VectorJ v;
    double kinetic_J;
  };

  double limit_J_;
  std::optional<Cycle> last_;
  double unexplained_J_ = 0.0;
  int cycles_ = 0;  ///< in a row with too much
};

}  // namespace limber::controller
