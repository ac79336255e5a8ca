#include "drivers/protocols/cycle_frames.h"

#include <algorithm>

#include "robots/loader/protocols/drive_protocol.h"
#include "robots/loader/protocols/tip_sensor_protocol.h"

namespace limber {
namespace {

CanFrame empty_frame(std::uint32_t id, int bytes, bool fd) {
  CanFrame frame;
  frame.id = id;
  frame.extended = id > kStandardIdMax;
  frame.fd = frame.bitrate_switch = fd;
  frame.length = static_cast<std::uint8_t>(fd ? fd_length(bytes) : std::min(bytes, 8));
  return frame;
}

std::vector<CanFrame> setting_frames(const DriveConfig& drive, bool fd) {
  if (drive.protocol->setting == nullptr) return {};
  const SettingFrames setting = drive.protocol->setting(drive);
  return {empty_frame(setting.request_id, 8, fd && !setting.classic),
          empty_frame(setting.answer_id, 8, fd && !setting.classic)};
}

Exchange exchange_with(const std::string& joint, const DriveConfig& drive, bool fd) {
  Exchange out{joint,
               empty_frame(drive.command_id, drive.frames.command, fd),
               {},
               drive.protocol->needs_sync,
               setting_frames(drive, fd)};
  for (std::size_t i = 0; i < drive.frames.replies.size(); ++i)
    out.replies.push_back(empty_frame(drive.reply(i), drive.frames.replies[i], fd));
  for (const std::uint32_t id : drive.frames.asked) {
    out.requests.push_back(empty_frame(id, 0, false));
    out.requests.back().remote = true;
  }
  return out;
}

Exchange exchange_with(const TipSensorConfig& sensor) {
  const TipSensorTraits& traits = traits_of(sensor.protocol);
  Exchange out{
      "tip sensor", empty_frame(sensor.command_id, traits.request_bytes, traits.fd), {}, false, {}};
  for (std::size_t i = 0; i < static_cast<std::size_t>(traits.replies); ++i)
    out.replies.push_back(empty_frame(sensor.reply_ids[i], traits.reply_bytes, traits.fd));
  return out;
}

}  // namespace

std::vector<Exchange> cycle_frames(const Robot& robot, int bus) {
  const bool fd = robot.buses[static_cast<std::size_t>(bus)].fd;
  std::vector<Exchange> all;
  for (const JointConfig& joint : robot.driven()) {
    for (int motor = 0; motor < joint.motors(); ++motor) {
      if (joint.motor(motor).bus == bus)
        all.push_back(exchange_with(joint.name, joint.motor(motor), fd));
    }
  }
  if (robot.has_tip_sensor && robot.tip_sensor.bus == bus)
    all.push_back(exchange_with(robot.tip_sensor));
  return all;
}

void fill_typical(CanFrame* frame, std::minstd_rand* random) noexcept {
  for (std::uint8_t& byte : frame->data)
    byte = (*random)() % 3 == 0 ? 0 : static_cast<std::uint8_t>((*random)() >> 8U);
}

}  // namespace limber
