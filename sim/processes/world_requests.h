// Live requests to the simulated world: pushes, walls, workpieces, payloads, faults of drives.
#pragma once

#include <functional>

#include "common/lcm_port.h"
#include "lcmtypes/channels.h"
#include "sim/simulator.h"

namespace limber::sim {

/// PUSH, SCENARIO_EVENT and WORKPIECE are handed to the simulator while `user` handles what waits;
/// `complain` gets the reason for one that is refused. All outlive the port. Set-up only; throws
/// ConfigError.
inline void take_world_requests(LcmPort* user, Simulator* simulator,
                                const std::function<void(const char*)>& complain) {
  constexpr int kQueue = 100;  // one now and then
  user->subscribe<push_t>(channels::kPush, kQueue, [simulator, complain](const push_t& push) {
    if (!simulator->push(push)) complain("a PUSH was refused (values, link, or no free slot)");
  });
  user->subscribe<scenario_event_t>(
      channels::kScenarioEvent, kQueue, [simulator, complain](const scenario_event_t& event) {
        if (!simulator->event(event))
          complain("a SCENARIO_EVENT was refused (values out of range)");
      });
  user->subscribe<workpiece_t>(channels::kWorkpiece, kQueue,
                               [simulator, complain](const workpiece_t& workpiece) {
                                 if (!simulator->workpiece(workpiece))
                                   complain("a WORKPIECE was refused (values out of range)");
                               });
}

}  // namespace limber::sim
