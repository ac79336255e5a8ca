// The joint torque loop of a drive's firmware: sensed torque fed back so that the rotor seems
// lighter than it is.
//
//   tau_m = rho u + (1 - rho)(tau + D_J / K_J tau'),   rho = B / B_theta
//
// Source: Ott, Albu-Schaeffer, Kugi, Hirzinger, "On the passivity-based impedance control of
// flexible joint robots", IEEE TRO 24 (2008). tau is sampled every 1 / rate and held; tau' is the
// difference of two samples, averaged with weight 1/2: the torque sensor is all it needs. A command
// takes effect at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "robots/loader/joint_chain.h"

namespace limber::sim {

/// Torques in N m. A value; after construction every member is allowed in the cycle.
class JointTorqueLoop {
 public:
  /// Longest delay, in samples; a longer one is cut down to it.
  static constexpr std::size_t kMaxDelay = 255;

  /// The delay is rounded to whole samples.
  explicit JointTorqueLoop(const TorqueLoopConfig& config);

  /// rho > 0; D_J / K_J in s.
  void set(double inertia_ratio, double damping_over_stiffness_s) noexcept {
    inertia_ratio_ = inertia_ratio;
    lead_s_ = damping_over_stiffness_s;
  }
  /// Samples the sensor if it is time to.
  void update(double sensed_torque, std::int64_t now_ns) noexcept;
  /// tau_m for the command u.
  double torque(double u) const noexcept {
    return inertia_ratio_ * u +
           (1.0 - inertia_ratio_) * past_[(newest_ + past_.size() - delay_) % past_.size()];
  }

 private:
  double rate_hz_;
  double inertia_ratio_ = 1.0;
  double lead_s_ = 0.0;
  std::int64_t samples_ = 0;
  double sensed_ = 0.0;
  double derivative_ = 0.0;
  std::array<double, kMaxDelay + 1> past_{};  // ring of tau + D_J / K_J tau'
  std::size_t newest_ = 0;
  std::size_t delay_ = 0;  // samples
};

}  // namespace limber::sim
