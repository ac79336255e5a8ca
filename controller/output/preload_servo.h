// Winds up the springs between two motors that pull against each other.
#pragma once

#include <cstdint>
#include <vector>

#include "common/types.h"
#include "controller/elastic/spring_law.h"
#include "controller/model/arm_state.h"
#include "controller/output/torque_blend.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Where the torque goes while no law runs.
enum class PreloadAtRest {
  kReleased,   ///< to zero
  kAsApplied,  ///< what the drives apply, as JOINT_STATE tells
};

/// For c = (theta_1 + theta_2) / 2, on which tau_1 + tau_2 acts with the inertia B = B_1 + B_2:
///   tau_preload = f(c_d + x) + f(c_d - x) - K_c (c - c_d) - D_c c'
///   K_c = B w^2,  D_c = 2 B w
/// x: deflection of the equilibrium from the link. The springs' force is fed forward where c shall
/// be, so that their own stiffness helps the servo; damping is against standstill, which keeps the
/// torque continuous where a ramp begins. c_d starts where the preload is and moves at a steady
/// rate to what is wanted. The torque starts from what the drives apply, and the difference fades
/// (TorqueBlend): springs that are not those of robot.yaml make no step. The joint's torque comes
/// first: |tau| + |tau_preload| stays within twice what the weaker motor can give; and the gate's
/// step is kept, from the torque before and from what the drives apply. Zero for joints with one
/// motor. After construction all members may be called in the cycle.
class PreloadServo {
 public:
  static constexpr double kBandwidth_rad_per_s = 30.0;
  static constexpr double kRampTime_s = 1.0;  ///< from slack to the greatest preload

  explicit PreloadServo(const Robot& robot);

  /// At once, or in steps the gate lets pass if `in_steps`.
  void rest(const ArmState& state, PreloadAtRest where, bool in_steps) noexcept;
  /// `wanted`: n, rad, kept within 0 and robot.yaml's greatest. x: n, rad; tau: joint torque of
  /// this cycle, n, N m. Returns LIMIT_* bits.
  std::int32_t control(const ArmState& state, const VectorJ& wanted, const VectorJ& x,
                       const VectorJ& tau, double dt_s) noexcept;

  const VectorJ& torque() const noexcept { return tau_; }
  /// robot.yaml's preload_rad, n.
  const VectorJ& preload_at_rest() const noexcept { return at_rest_; }

 private:
  struct Motors {
    Eigen::Index joint;
    SpringPair springs;
    double B;
    double preload_max_rad;
    double torque_Nm;      // of the weaker one
    double rate_Nm_per_s;  // of the joint's torque
  };

  double servo(const Motors& pair, const ArmState& state, double wanted, double x,
               double dt_s) noexcept;

  std::vector<Motors> pairs_;
  VectorJ at_rest_;
  VectorJ c_d_;
  TorqueBlend blend_;
  bool resting_ = true;
  VectorJ tau_;
};

}  // namespace limber::controller
