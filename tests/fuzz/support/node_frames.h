// An emulated motor node, receiving whatever the bus brings while its joint moves: what it answers
// can be carried, it never talks without end, and its torque stays finite.
#pragma once

#include <cmath>

#include "sim/nodes/motor_node.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/require.h"

namespace limber::fuzz {

inline constexpr int kMostFramesAtOnce = 100;

inline void fuzz_node(const JointConfig& joint, bool fd, FuzzInput input) {
  const auto node = sim::make_motor_node(joint, fd);
  sim::JointReading reading;
  std::int64_t now_ns = 0;
  while (!input.empty()) {
    const auto kind = input.take<std::uint8_t>();
    CanFrame frame;
    if (kind % 4 != 0) {
      if (node->receive(input.frame(), reading, now_ns, &frame))
        require(is_possible(frame), "an answer can be carried");
    } else if (kind % 8 == 0) {
      now_ns += 1000 * std::int64_t{input.take<std::uint16_t>()};
      for (double* number : {&reading.theta, &reading.theta_dot, &reading.q, &reading.v,
                             &reading.motor_torque, &reading.joint_torque, &reading.current_A})
        *number = input.small();
      node->update(reading, now_ns);
    } else {
      node->inject(input.take<std::uint8_t>() % 8, reading, now_ns + input.take<std::uint32_t>());
    }
    int frames = 0;
    while (node->next_frame(&frame)) {
      require(is_possible(frame), "an unsolicited frame can be carried");
      require(++frames <= kMostFramesAtOnce, "a node comes to an end");
    }
    const sim::DriveLaw law = node->law();
    require_finite({law.kp, law.kd, law.q_des, law.v_des, law.tau_ff, law.limit,
                    law.passive_damping, law.torque(reading.theta, reading.theta_dot)},
                   "the torque of a node is finite");
  }
}

}  // namespace limber::fuzz
