// The torque sensor between spring and link.
//
//   reading = round(filter(scale * torque + bias + noise)), delay_s later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "robots/loader/joint_chain.h"

namespace limber::sim {

/// A value; after construction every member is allowed in the cycle.
class TorqueSensor {
 public:
  /// Longest delay, in updates; a longer one is cut down to it.
  static constexpr std::size_t kMaxDelay = 255;

  /// Ideal: reads the torque of the last update.
  TorqueSensor() = default;
  /// Sensors with other seeds have other noise.
  TorqueSensor(const TorqueSensorConfig& config, unsigned seed);

  /// The torque (N m) that was there for the last h > 0 seconds; h is the same in every call. The
  /// first update finds the sensor settled at it.
  void update(double true_torque, double h) noexcept;
  double reading() const noexcept;  ///< N m; zero before the first update

 private:
  TorqueSensorConfig config_;
  std::uint64_t noise_key_ = 0;
  bool started_ = false;
  double filtered_ = 0.0;
  std::array<double, kMaxDelay + 1> past_{};  // ring of filtered values
  std::size_t newest_ = 0;
  std::size_t delay_ = 0;  // updates
};

}  // namespace limber::sim
