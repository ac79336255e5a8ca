// Contact wrench from a force/torque sensor at the tip: what it reads, less what the tool does.
//
//   f = R_BS f_S' - w                 w = m (g - a_C), the tool's weight and inertia force
//   mu = R_BS mu_S' - r_SC x w + r_TS x f
//
// f_S', mu_S': reading less bias. r_SC, r_TS: from the sensor's origin to the tool's centre of
// mass, from the tip origin to the sensor's; base axes. a_C = a + alpha x r_TC + omega x (omega x
// r_TC). Source: Newton for a rigid tool that is taken for a point mass; B. Siciliano, O. Khatib
// (eds.), Springer Handbook of Robotics (2016), ch. 9 and 28.
#pragma once

#include <cstdint>

#include "common/types.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Wrench of the environment on the arm: base axes, tip origin as reference point, N and N m.
/// After construction no member allocates, locks, logs or throws; all may be called in the cycle.
class TipForce {
 public:
  /// For an arm with a tip sensor.
  explicit TipForce(const Robot& robot);

  /// A reading and the terms at its state. `A_BT` is the tip's acceleration, dV_BT/dt, in base
  /// axes, m/s^2 and rad/s^2: J qdd + Jdot_v, or zero where the tool's inertia does not matter.
  /// Without a usable reading, or with a number that is not finite, the result is invalid and zero;
  /// within the bridged cycles it is made of the last reading.
  void update(const TipReading& reading, const ArmTerms& terms, const Vector6& A_BT) noexcept;

  /// The present contact wrench is taken for an error of the sensor's bias and no longer shown.
  /// Nothing may touch the tool. False, and nothing done, without a valid result.
  bool tare() noexcept;

  const Vector6& F_ext() const noexcept { return F_ext_; }
  bool valid() const noexcept { return valid_; }
  /// Cycles since the reading F_ext is made of.
  std::int32_t age_cycles() const noexcept { return age_cycles_; }

 private:
  Vector6 tool_wrench(const ArmTerms& terms, const Vector6& A_BT) const noexcept;

  Eigen::Vector3d gravity_;
  Eigen::Vector3d p_TS_;
  Eigen::Quaterniond Q_TS_;
  double tool_mass_;
  Eigen::Vector3d p_SC_;
  Vector6 bias_;

  Eigen::Matrix3d R_BS_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d r_TS_ = Eigen::Vector3d::Zero();
  Vector6 F_ext_ = Vector6::Zero();
  bool valid_ = false;
  std::int32_t age_cycles_ = 0;
};

}  // namespace limber::controller
