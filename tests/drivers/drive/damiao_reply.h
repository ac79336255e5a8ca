// A Damiao motor's state reply by hand, for tests of one joint's end of the bus.
#pragma once

#include <cmath>

#include "drivers/drive/joint_link.h"
#include "tests/drivers/fake_arm.h"

namespace limber::testing {

constexpr int kDisabled = 0, kEnabled = 1, kOverCurrent = 10;  // the state's nibble

/// What test_robot()'s first motor reports: ranges of +-12.5 rad, +-30 rad/s, +-10 N m.
struct DamiaoReply {
  int state = kEnabled;
  double angle_rad = 0.0;
  double speed_rad_per_s = 0.0;
  double torque_Nm = 0.0;

  CanFrame frame() const {
    const auto count = [](double x, double most, int bits) {
      return static_cast<int>(std::lround((x + most) / (2.0 * most) * ((1 << bits) - 1)));
    };
    const int p = count(angle_rad, 12.5, 16);
    const int v = count(speed_rad_per_s, 30.0, 12);
    const int t = count(torque_Nm, 10.0, 12);
    CanFrame made;
    made.id = 0x11;
    made.length = 8;
    const int bytes[8] = {state << 4 | 1,         p >> 8,  p & 255, v >> 4,
                          (v & 15) << 4 | t >> 8, t & 255, 30,      35};
    for (std::size_t i = 0; i < 8; ++i) made.data[i] = static_cast<std::uint8_t>(bytes[i]);
    return made;
  }
};

/// One cycle in which the motor answers.
inline void answer(JointLink* link, const DamiaoReply& reply) {
  link->begin_cycle();
  link->forget_angle();
  link->receive(reply.frame());
}

}  // namespace limber::testing
