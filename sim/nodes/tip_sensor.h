// The simulated arm's force/torque sensor: its mechanics and its bus node.
#pragma once

#include "sim/nodes/tip_sensor_node.h"
#include "sim/plant/tip_load.h"

namespace limber::sim {

struct TipSensor {
  TipSensor(const TipSensorConfig& config, const LinkDynamics& arm)
      : bus(config.bus), load(config, arm), node(config) {}

  /// After an integration step of h seconds that ended at simulated time t. Allowed in the cycle.
  void update(const LinkDynamics& arm, const Environment& environment, double h,
              std::int64_t t_ns) noexcept {
    load.step(arm, environment, h, t_ns);
    node.update(load.F(), h, t_ns);
  }

  int bus;
  TipLoad load;
  TipSensorNode node;
};

}  // namespace limber::sim
