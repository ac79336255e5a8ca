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
  const auto take = [&]<typename Request>(const char* channel,
                                          bool (Simulator::*change)(const Request&) noexcept,
                                          const char* refused) {
    user->subscribe<Request>(channel, kQueue,
                             [simulator, complain, change, refused](const Request& request) {
                               if (!(simulator->*change)(request)) complain(refused);
                             });
  };
  take(channels::kPush, &Simulator::push, "a PUSH was refused (values, link, or no free slot)");
  take(channels::kScenarioEvent, &Simulator::event,
       "a SCENARIO_EVENT was refused (values out of range)");
  take(channels::kWorkpiece, &Simulator::workpiece,
       "a WORKPIECE was refused (values out of range)");
}

}  // namespace limber::sim
