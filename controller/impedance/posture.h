// The null-space torque, cycle by cycle.
#pragma once

#include <utility>

#include "controller/impedance/nullspace.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// null_space_torque() with what it has to remember. All members may be called in the cycle.
class Posture {
 public:
  /// `torque_limit`: n, N m, of which the posture may take kShare.
  Posture(const TaskRows& rows, const VectorJ& torque_limit)
      : limit_(kShare * torque_limit), rows_(rows), last_torque_(VectorJ::Zero(limit_.size())) {}

  /// Torque of this cycle, n, N m.
  const VectorJ& update(const ControlPoint& point, const ArmTerms& terms, const Goal& goal,
                        const Gains& gains) noexcept {
    const TaskRows rows(gains.K_x);
    rows_changed_ = rows_changed_ || !(rows == rows_);
    rows_ = rows;
    last_torque_ = null_space_torque(point, terms, goal, gains, rows, limit_);
    return last_torque_;
  }
  /// A cycle in which no posture is held.
  const VectorJ& rest() noexcept {
    last_torque_.setZero();
    return last_torque_;
  }

  /// Of the last update() or rest().
  const VectorJ& last_torque() const noexcept { return last_torque_; }
  /// True once if the task lost or gained a direction: the torque has to be blended.
  bool rows_changed() noexcept { return std::exchange(rows_changed_, false); }

 private:
  static constexpr double kShare = 0.3;

  VectorJ limit_;
  TaskRows rows_;
  VectorJ last_torque_;
  bool rows_changed_ = false;
};

}  // namespace limber::controller
#pragma GCC visibility pop
