// A drive family that exists only in tests. Command to 0x100 + id, 24 bytes: mode, three unused,
// float32 angle, speed, kp, kd, torque. Reply with 0x300 + id, 16 bytes: mode, three unused, angle,
// speed, torque. All at the drive's output, in SI units, little-endian. Modes: 0 off, 1 on, 2
// failed (in a command: clear the error), 3 (in a command): a request of the state.
#pragma once

#include <array>
#include <memory>

#include "drivers/families/drive_family.h"
#include "qa/faults/state_change.h"
#include "sim/nodes/motor_node.h"
#include "tools/can/drive_decoders.h"

namespace limber::toy {

inline constexpr std::uint32_t kCommandId = 0x100;
inline constexpr std::uint32_t kReplyId = 0x300;
enum Mode : std::uint8_t { kOff, kOn, kFailed, kRequest };

struct Command {
  Mode mode = kOff;
  std::array<float, 5> values{};  ///< angle, speed, kp, kd, torque
};
struct State {
  Mode mode = kOff;
  std::array<float, 3> values{};  ///< angle, speed, torque
};
CanFrame encode(const Command& command, std::uint32_t id) noexcept;
CanFrame encode(const State& state, std::uint32_t id) noexcept;
/// False if the frame has another identifier or length.
bool decode(const CanFrame& frame, std::uint32_t id, Command* command) noexcept;
bool decode(const CanFrame& frame, std::uint32_t id, State* state) noexcept;

}  // namespace limber::toy

namespace limber {

std::unique_ptr<DriveCodec> toy_codec(const JointConfig& joint);
std::unique_ptr<StartupDialogue> toy_startup(const JointConfig& joint);
std::unique_ptr<IntruderRules> toy_intruders(const JointConfig& joint);
namespace sim {
std::unique_ptr<MotorNode> make_toy_node(const JointConfig& joint);
}
namespace bus_tools {
std::unique_ptr<FrameDecoder> make_toy_decoder(const Motor& motor);
void add_toy_messages(const Motor& motor, const BusFacts& bus, std::vector<dbc::Message>* messages);
}  // namespace bus_tools
namespace faults {
CanFrame with_motion_of_toy(const CanFrame& reply, const JointConfig& joint, bool fd,
                            const MotionChange& change);
}

}  // namespace limber
