// Does the arm move with energy that its torques have not given it?
#pragma once

#include <limber/joint_state_t.hpp>
#include <optional>
#include <vector>

#include "common/joints.h"
#include "common/types.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// The kinetic energy of an arm changes by the work of its motors, of its springs and weight, and
/// of the world:
///
///   T = v^T M v / 2 + w^T B w / 2,
///   dT = w^T (tau - tau_s) dt + v^T (tau_s - g) dt + dW_world
///
/// with link inertia M, rotor inertia B, link velocity v, motor velocity w, and the springs' torque
/// tau_s; w = v for rigid joints, and tau_s cancels. W_world is what is left over. Friction takes
/// from it; a hand, a falling load, a drive that makes the opposite torque, or a model with the
/// wrong weight give to it. A hand that pushes against a spring gives much work to the spring but
/// the arm hardly any speed. So what counts is the lesser of the two: the arm moves with more than
/// limit_J, and that much has come from outside within about kMemory_s. What friction has taken
/// before is no credit. It must be too much for kCycles in a row: a velocity that is wrong for a
/// moment is the driver's to find.
///
/// An arm with a spring in a joint without link encoder is not watched: its links are not seen.
class EnergyWatch {
 public:
  static constexpr double kMemory_s = 0.5;
  static constexpr int kCycles = 5;

  /// For set-up.
  explicit EnergyWatch(const Robot& robot);

  // May be called in the cycle.

  /// The drives do not follow: what the arm does now is not their work.
  void reset() noexcept {
    last_.reset();
    unexplained_J_ = 0.0;
  }

  struct Model {
    const MatrixJ& M;  ///< of the links, kg m^2
    const VectorJ& B;  ///< of the rotors, kg m^2
    VectorJ g;         ///< torque that would hold the links' weight, N m
    VectorJ tau_s;     ///< of the springs on the links, N m; zero for rigid joints
  };
  /// Once a cycle with drives that follow: whether it is too much. `dt_s`: since the last call. A
  /// value that is not finite is too much.
  bool exceeded(const joint_state_t& state, const Model& model, double dt_s) noexcept;
  /// W_world as it counts, J; never negative.
  double unexplained_J() const noexcept { return unexplained_J_; }

 private:
  struct Cycle {
    VectorJ v;      ///< of the links
    VectorJ w;      ///< of the motors
    VectorJ tau_s;  ///< of the springs
    double kinetic_J;
  };
  Cycle cycle(const joint_state_t& state, const Model& model) const noexcept;

  double limit_J_;
  std::vector<bool> sprung_;  ///< by joint
  std::optional<Cycle> last_;
  double unexplained_J_ = 0.0;
  int cycles_ = 0;  ///< in a row with too much
};

}  // namespace limber::controller
