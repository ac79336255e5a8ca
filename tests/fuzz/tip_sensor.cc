// Both protocols of the force/torque sensor at the tip, both ways: requests that the emulated
// sensor receives, replies that the driver reads.
#include <limber/joint_state_t.hpp>
#include <string>

#include "drivers/drive/tip_sensor_link.h"
#include "sim/nodes/tip_sensor_node.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

namespace {

TipSensorConfig sensor_of(TipSensorProtocol protocol) {
  TipSensorConfig sensor;
  sensor.protocol = protocol;
  sensor.command_id = 0x64;
  sensor.reply_ids = {0x65, 0x66};
  sensor.range.fill(100.0);
  sensor.noise.fill(0.1);
  return sensor;
}

void read_replies(const TipSensorConfig& sensor, fuzz::FuzzInput input) {
  TipSensorLink link(sensor, 2);
  joint_state_t state{};
  while (!input.empty()) {
    const auto kind = input.take<std::uint8_t>();
    if (kind % 4 == 0) {
      link.close_cycle();
      link.begin_cycle();
      fuzz::require(is_possible(link.next_frame()), "a request can be carried");
    } else if (const CanFrame frame = input.frame(); link.is_mine(0, frame)) {
      link.receive(frame, kind % 4 == 1);
    }
    link.write_state(&state);
    for (const double component : state.F_sensor)
      fuzz::require_finite({component}, "a wrench is finite");
  }
}

void answer_requests(const TipSensorConfig& sensor, fuzz::FuzzInput input) {
  sim::TipSensorNode node(sensor);
  std::int64_t now_ns = 0;
  while (!input.empty()) {
    if (input.take<std::uint8_t>() % 4 == 0) {
      Vector6 F;
      for (double& component : F) component = input.small();
      node.update(F, 1e-3, now_ns += 1'000'000);
    }
    for (const CanFrame& answer : node.receive(input.frame()))
      fuzz::require(is_possible(answer), "an answer can be carried");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const auto protocol : {TipSensorProtocol::kRobotousRft, TipSensorProtocol::kLimberFt}) {
    read_replies(sensor_of(protocol), {data, size});
    answer_requests(sensor_of(protocol), {data, size});
  }
  return 0;
}
