// What the part of the arm beyond a force/torque sensor exerts on the sensor.
//
//   F_S = F_contact + sum_i m_i (g - a_i)      at the sensor origin, sensor axes
//
// (Newton for each mass beyond the sensor; what holds it is what the sensor feels, with the sign
// turned.) F_contact: the wall, and pushes on the tip link. Masses: the tool of robot.yaml and the
// scenario's payload, both point masses. Pushes on other links are taken to act before the sensor.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "robots/loader/tip_sensor_config.h"
#include "sim/world/environment.h"

namespace limber::sim {

/// After construction every member is allowed in the cycle.
class TipLoad {
 public:
  /// `arm` is at its start.
  TipLoad(const TipSensorConfig& sensor, const LinkDynamics& arm);

  /// The payload changed; `arm` is where it happens. kg, tip axes.
  void set_payload(const LinkDynamics& arm, double mass, const Eigen::Vector3d& p_T) noexcept;

  /// After an integration step of h seconds that ended at simulated time t, with `arm` at its end.
  /// Accelerations are means over the step: (v_end - v_begin) / h.
  void step(const LinkDynamics& arm, const Environment& environment, double h,
            std::int64_t t_ns) noexcept;

  const Vector6& F() const noexcept { return F_; }

 private:
  struct PointMass {
    double mass = 0.0;
    Eigen::Vector3d p_T = Eigen::Vector3d::Zero();
    Eigen::Vector3d v = Eigen::Vector3d::Zero();  ///< at the last step's end, base axes
  };
  static Eigen::Vector3d position(const LinkDynamics& arm, const PointMass& mass) noexcept;
  static Eigen::Vector3d velocity(const LinkDynamics& arm, const PointMass& mass) noexcept;

  Eigen::Vector3d p_TS_;
  Eigen::Matrix3d R_TS_;
  std::array<PointMass, 2> masses_;  ///< tool, payload
  Vector6 F_ = Vector6::Zero();
};

}  // namespace limber::sim
