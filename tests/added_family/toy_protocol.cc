#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "robots/loader/protocols/drive_protocol.h"
#include "tests/added_family/toy.h"

namespace limber {
namespace toy {
namespace {

template <std::size_t N>
CanFrame frame_of(Mode mode, const std::array<float, N>& values, std::uint32_t id) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.fd = frame.bitrate_switch = true;
  frame.length = 4 + 4 * N;
  frame.data[0] = mode;
  std::memcpy(frame.data.data() + 4, values.data(), 4 * N);
  return frame;
}

template <std::size_t N>
bool read(const CanFrame& frame, std::uint32_t id, Mode* mode, std::array<float, N>* values) {
  if (!has_id(frame, id) || frame.length != 4 + 4 * N || frame.data[0] > kRequest) return false;
  *mode = static_cast<Mode>(frame.data[0]);
  std::memcpy(values->data(), frame.data.data() + 4, 4 * N);
  return true;
}

}  // namespace

CanFrame encode(const Command& command, std::uint32_t id) noexcept {
  return frame_of(command.mode, command.values, id);
}
CanFrame encode(const State& state, std::uint32_t id) noexcept {
  return frame_of(state.mode, state.values, id);
}
bool decode(const CanFrame& frame, std::uint32_t id, Command* command) noexcept {
  return read(frame, id, &command->mode, &command->values);
}
bool decode(const CanFrame& frame, std::uint32_t id, State* state) noexcept {
  return read(frame, id, &state->mode, &state->values);
}

}  // namespace toy

namespace {

constexpr ProtocolKey kRequired[] = {
    {"motors.*", "toy_speed_rad_per_s", "of the motor", {1.0, Figure::kSpeed, 2.0}, "datasheet"},
};
constexpr const char* kKeys[] = {"toy_speed_rad_per_s"};

void read_motor(const YamlMap& yaml, DriveConfig* drive) {
  constexpr double kNoEnd = INFINITY;
  yaml.number("toy_speed_rad_per_s", {0.1, 1000.0});
  drive->range = {kNoEnd, kNoEnd, kNoEnd, kNoEnd, kNoEnd};
  drive->counts_per_turn = std::exp2(24);
}

void read_ids(const YamlMap& yaml, DriveConfig* drive) {
  const auto id = static_cast<std::uint32_t>(yaml.integer("id", 1, 15));
  drive->command_id = toy::kCommandId + id;
  drive->reply_id = toy::kReplyId + id;
}

std::string address(const DriveConfig& drive) {
  return fmt::format("toy {}", drive.command_id - toy::kCommandId);
}

FrameSizes frames(const JointConfig& /*joint*/, bool /*fd*/) { return {24, {16}}; }

}  // namespace

extern const DriveProtocol kToy;
const DriveProtocol kToy = {
    .word = "toy",
    .title = "Toy",
    .needs_fd = true,
    .required = kRequired,
    .keys = kKeys,
    .read_motor = read_motor,
    .read_ids = read_ids,
    .address = address,
    .frames = frames,
};

}  // namespace limber
