// A driver of your own in sixty lines: limber's encoders, the simulated motors of `limber sim
// desktop2r`, no other part of limber. Holds both joints where they are, soft, and prints how they
// yield.   ./client virtual:desktop2r | socketcan:can0
#include <array>
#include <chrono>
#include <cstdio>
#include <map>
#include <thread>
#include <utility>

#include "drivers/can/can_bus.h"
#include "drivers/protocols/mit.h"

using namespace limber;
using namespace std::chrono_literals;

namespace {

// robots/desktop2r/robot.yaml: identifiers and ranges of two DM4310.
constexpr std::array kMotors = {std::pair{1u, 0x11u}, std::pair{2u, 0x12u}};
const CommandRange kRange{.position_rad = 12.5, .velocity_rad_per_s = 30.0, .torque_Nm = 10.0};

/// What has come from the motors, by the identifier that they answer with.
std::map<unsigned, mit::Reply> take_replies(CanBus& bus) {
  std::map<unsigned, mit::Reply> replies;
  CanFrame frame;
  while (bus.receive(std::span(&frame, 1)) == 1) {
    mit::Reply reply;
    if (mit::decode_reply(frame, kRange, &reply)) replies[frame.id] = reply;
  }
  return replies;
}

}  // namespace

int main(int argc, char** argv) {
  const auto bus = open_can_bus(argc > 1 ? argv[1] : "virtual:desktop2r", false);
  std::map<unsigned, mit::Reply> start;
  for (int attempt = 0; attempt < 50 && start.size() < kMotors.size(); ++attempt) {  // for a second
    for (const auto& [id, reply_id] : kMotors)
      bus->send(mit::encode_special(mit::Special::kEnable, id, false));
    std::this_thread::sleep_for(20ms);
    start.merge(take_replies(*bus));
  }
  if (start.size() != kMotors.size()) {
    std::fprintf(stderr, "%zu of 2 motors answer: is `limber sim desktop2r` running?\n",
                 start.size());
    return 3;
  }
  auto last = start;
  for (int cycle = 0; cycle < 200; ++cycle) {  // 2 s at 100 Hz
    for (const auto& [id, reply_id] : kMotors) {
      const mit::Command hold{.position_rad = start.at(reply_id).position_rad,
                              .kp_Nm_per_rad = 40.0,
                              .kd_Nms_per_rad = 1.0};
      CanFrame frame;
      if (mit::encode_command(hold, kRange, id, false, mit::Quantiser::kRound, &frame))
        bus->send(frame);
    }
    std::this_thread::sleep_for(10ms);
    for (const auto& [reply_id, reply] : take_replies(*bus)) last[reply_id] = reply;
    if (cycle % 50 != 49) continue;
    for (const auto& [reply_id, reply] : last) {
      std::printf("motor %u: %+.3f rad from its start, %+.2f Nm  ", reply.id_nibble,
                  reply.position_rad - start.at(reply_id).position_rad, reply.torque_Nm);
    }
    std::printf("\n");
  }
  for (const auto& [id, reply_id] : kMotors)
    bus->send(mit::encode_special(mit::Special::kDisable, id, false));
}
