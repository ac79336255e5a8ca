#include "tests/added_family/toy.h"

namespace limber::faults {

CanFrame with_motion_of_toy(const CanFrame& reply, const JointConfig& joint, bool /*fd*/,
                            const MotionChange& change) {
  toy::State state;
  if (!toy::decode(reply, joint.drive.reply_id, &state)) return reply;
  state.values[0] += static_cast<float>(change.angle_rad);
  state.values[1] += static_cast<float>(change.speed_rad_per_s);
  return toy::encode(state, reply.id);
}

}  // namespace limber::faults
