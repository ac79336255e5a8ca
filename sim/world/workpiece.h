// What the tip touches with a shape, as workpiece_t describes it.
#pragma once

#include <limber/workpiece_t.hpp>
#include <variant>

#include "common/types.h"
#include "sim/world/block.h"
#include "sim/world/hole.h"

namespace limber::sim {

/// The tip frame and its twist, base axes.
struct TipMotion {
  Eigen::Vector3d p, v, w;
  Eigen::Matrix3d R;
};

/// Allowed in the cycle throughout.
class Workpiece {
 public:
  bool there() const noexcept { return shape_.index() != 0; }
  const Block* block() const noexcept { return std::get_if<Block>(&shape_); }

  /// On the arm, at the tip origin.
  Vector6 wrench(const TipMotion& tip) const noexcept;
  /// The hardest contact that an explicit step can carry, for a tip with this mobility in whatever
  /// direction, 1/kg.
  void limit_to(double mobility, double h) noexcept;
  /// What moves of it moves on by one step, at whose end the tip is.
  void advance(const TipMotion& tip, double h) noexcept;

 private:
  friend bool read_workpiece(const workpiece_t&, const Eigen::Vector3d&, Workpiece*) noexcept;

  Eigen::Vector3d force_at(const TipMotion& tip, const Eigen::Vector3d& ball,
                           const Touch& touch) const noexcept;

  std::variant<std::monostate, Hole, Block> shape_;
  ContactMaterial material_;
  double tip_radius_ = 0.0;
  Eigen::Vector3d peg_ = Eigen::Vector3d::Zero();  ///< its other end, tip axes; zero: none
};

/// False, and nothing written, if a value is not finite, out of range, or the tip's ball does not
/// pass the hole. `gravity`: base axes, m/s^2.
[[nodiscard]] bool read_workpiece(const workpiece_t& message, const Eigen::Vector3d& gravity,
                                  Workpiece* workpiece) noexcept;

}  // namespace limber::sim
