// A CANopen drive for the driver's tests: reads and writes the bytes itself, so that neither the
// protocol library nor the simulator can hide a mistake of the driver.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "robots/loader/protocols/drive_protocol.h"
#include "tests/drivers/fake_arm.h"
#include "tests/support/frame_text.h"

namespace limber::testing {

/// Statuswords with voltage present, remote; enabled it follows its target (bit 12).
constexpr int kSwitchOnDisabled = 0x0250, kReady = 0x0231, kSwitchedOn = 0x0233,
              kOperationEnabled = 0x1237, kFault = 0x0218;

/// Expedited SDO, NMT, one RPDO and the TPDOs at the SYNC: one on an FD bus, else two or three.
/// They tell what was before the RPDO.
class FakeCia402 {
 public:
  explicit FakeCia402(const JointConfig& joint, bool on_fd = true)
      : config(joint), fd(on_fd), node(static_cast<int>(joint.drive.command_id & 0x7F)) {
    const auto counts = [](int bits) { return 1U << static_cast<unsigned>(bits); };
    objects = {{0x100000, {4, 0x00020192}},
               {0x604000, {2, 0}},
               {0x604100, {2, kSwitchOnDisabled}},
               {0x605E00, {2, 0}},
               {0x606000, {1, 0}},
               {0x606100, {1, 0}},
               {0x607200, {2, 1000}},
               {0x607600, {4, static_cast<std::uint32_t>(1000 * joint.drive.rated_torque_Nm)}},
               {0x608F01, {4, static_cast<std::uint32_t>(joint.drive.counts_per_turn)}},
               {0x608F02, {4, 1}},
               {0x60C201, {1, 0}},
               {0x60C202, {1, 0}},
               {0x60E601, {4, counts(joint.link_encoder.bits)}},
               {0x600700, {2, 0}},
               {0x650200, {4, 0x00000200}},
               {0x201001, {4, 0}},
               {0x201002, {4, 0}},
               {0x201003, {4, 0}},
               {0x201004, {4, 4000}},
               {0x201005, {4, 100}},
               {0x201101, {4, 500}}};
    for (std::uint32_t record : {0x1400U, 0x1800U, 0x1801U, 0x1802U}) {
      for (std::uint32_t sub : {1U, 2U, 5U}) objects[record << 8U | sub] = {sub == 1 ? 4 : 2, 0};
    }
    for (std::uint32_t mapping : {0x1600U, 0x1A00U, 0x1A01U, 0x1A02U}) {
      for (std::uint32_t sub = 0; sub < 9; ++sub)
        objects[mapping << 8U | sub] = {sub == 0 ? 1 : 4, 0};
    }
  }

  /// What it says to a frame.
  std::vector<CanFrame> handle(const CanFrame& frame) {
    const auto id = static_cast<int>(frame.id);
    const bool for_me =
        id == 0x600 + node || id == 0x200 + node || (id == 0 && frame.data[1] == node);
    if (for_me) heard.push_back(text(frame));
    if (id == 0x080) return on_sync();
    if (!for_me) return {};
    if (id == 0) {
      operational = frame.data[0] == 1 && !never_operational;
    } else if (id == 0x200 + node) {
      if (operational) waiting = frame;
      has_waiting = operational;
    } else {
      return answer_sdo(frame);
    }
    return {};
  }

  struct Value {
    int bytes;
    std::uint32_t raw;
  };

  JointConfig config;
  bool fd;
  int node;
  std::map<std::uint32_t, Value> objects;  ///< by index << 8 | subindex
  std::set<std::uint32_t> read_only;       ///< acknowledged, but not taken
  std::set<std::uint32_t> mute;            ///< not answered
  bool stubborn = false;                   ///< ignores every controlword
  bool forgetful = false;                  ///< answers every SDO request at its second time only
  bool silent = false;                     ///< sends nothing
  std::set<int> withheld;                  ///< TPDOs, from 1 on, that it does not send
  bool never_operational = false;
  int when_enabled = kOperationEnabled;
  bool operational = false;
  std::vector<std::string> heard;
  int position = 0, velocity = 0, torque = 0, current = 0, link_position = 0, link_velocity = 0;

  int status() const { return static_cast<int>(objects.at(0x604100).raw); }
  void set_status(int value) { objects[0x604100].raw = static_cast<std::uint32_t>(value); }
  /// Controlword and torque of the last RPDO.
  int controlword() const { return waiting.data[0] | waiting.data[1] << 8; }
  int permille() const { return static_cast<std::int16_t>(waiting.data[2] | waiting.data[3] << 8); }

 private:
  std::vector<CanFrame> on_sync() {
    if (!operational) return {};
    const std::vector<CanFrame> told = fd ? fd_tpdos() : classic_tpdos();
    if (has_waiting) obey(controlword());
    has_waiting = false;
    return silent ? std::vector<CanFrame>{} : told;
  }

  struct Field {
    int value, bytes;
  };
  CanFrame tpdo(int number, const std::vector<Field>& fields) const {
    CanFrame frame;
    frame.id = static_cast<unsigned>(0x80 + 0x100 * number + node);
    for (const Field& field : fields) {
      for (int i = 0; i < field.bytes; ++i)
        frame.data[frame.length++] =
            static_cast<std::uint8_t>(static_cast<unsigned>(field.value) >> (8 * i));
    }
    return frame;
  }
  std::vector<CanFrame> fd_tpdos() const {
    const bool link = config.link_encoder.present;
    CanFrame frame = tpdo(1, {{status(), 2},
                              {position, 4},
                              {velocity, 4},
                              {torque, 2},
                              {current, 2},
                              {link_position, link ? 4 : 0},
                              {link_velocity, link ? 4 : 0}});
    frame.fd = frame.bitrate_switch = true;
    frame.length = link ? 24 : 16;
    return {frame};
  }
  std::vector<CanFrame> classic_tpdos() const {
    std::vector<CanFrame> frames;
    if (withheld.count(1) == 0) frames.push_back(tpdo(1, {{status(), 2}, {position, 4}}));
    if (withheld.count(2) == 0) {
      const int current_bytes = config.torque_sensor.present ? 2 : 0;
      frames.push_back(tpdo(2, {{velocity, 4}, {torque, 2}, {current, current_bytes}}));
    }
    if (config.link_encoder.present && withheld.count(3) == 0)
      frames.push_back(tpdo(3, {{link_position, 4}, {link_velocity, 4}}));
    return frames;
  }

  void obey(int controlword) {
    const bool reset = (controlword & 0x80) != 0 && (before & 0x80) == 0;
    before = controlword;
    if (stubborn) return;
    if (status() == kFault) {
      if (reset) set_status(kSwitchOnDisabled);
      return;
    }
    if ((controlword & 0x02) == 0) set_status(kSwitchOnDisabled);
    if (controlword == 0x06) set_status(kReady);
    if (controlword == 0x07 && status() == kReady) set_status(kSwitchedOn);
    if (controlword == 0x0F && status() == kSwitchedOn) set_status(when_enabled);
  }

  std::vector<CanFrame> answer_sdo(const CanFrame& request) {
    const std::uint32_t object = static_cast<std::uint32_t>(request.data[1]) << 8U |
                                 static_cast<std::uint32_t>(request.data[2]) << 16U |
                                 request.data[3];
    CanFrame reply = request;
    reply.id = 0x580U + static_cast<unsigned>(node);
    std::uint32_t raw = 0;
    for (int i = 0; i < 4; ++i)
      raw |= static_cast<std::uint32_t>(request.data[static_cast<std::size_t>(4 + i)]) << (8 * i);
    const auto entry = objects.find(object);
    if (entry == objects.end()) {
      reply.data[0] = 0x80;
      const auto same_index = objects.lower_bound(object & 0xFFFF00U);
      const bool record = same_index != objects.end() && same_index->first >> 8U == object >> 8U;
      raw = record ? 0x06090011 : 0x06020000;
    } else if (request.data[0] == 0x40) {
      reply.data[0] = static_cast<std::uint8_t>(0x43 | (4 - entry->second.bytes) << 2);
      raw = entry->second.raw;
    } else {
      reply.data[0] = 0x60;
      write(object, raw);
      raw = 0;
    }
    for (int i = 0; i < 4; ++i)
      reply.data[static_cast<std::size_t>(4 + i)] = static_cast<std::uint8_t>(raw >> (8 * i));
    const bool first = asked.insert(text(request)).second;
    if (silent || mute.count(object) != 0 || (forgetful && first)) return {};
    return {reply};
  }

  void write(std::uint32_t object, std::uint32_t raw) {
    if (read_only.count(object) != 0) return;
    objects[object].raw = raw;
    if (object == 0x606000 && read_only.count(0x606100) == 0) objects[0x606100].raw = raw;
    if (object == 0x604000) obey(static_cast<int>(raw));
  }

  CanFrame waiting;
  bool has_waiting = false;
  int before = 0;  ///< controlword
  std::set<std::string> asked;
};

/// Nodes 3 and 4, 28 N m rated, limited to half of that. The second counts the other way round,
/// with its zero elsewhere, and has a link encoder, a torque sensor and a torque loop.
inline Robot cia402_robot(bool fd = true) {
  Robot robot = test_robot(2);
  robot.buses[0].fd = fd;
  if (!fd) robot.rate_hz = 500.0;  // what 1 Mbit/s carries
  for (std::size_t i = 0; i < 2; ++i) {
    JointConfig& joint = robot.joints[i];
    joint.torque_limit_Nm = 14.0;
    joint.torque_rate_limit_Nm_per_s = 14000.0;
    joint.drive.protocol = &protocol_named("cia402");
    joint.drive.command_id = static_cast<std::uint32_t>(0x203 + i);
    joint.drive.reply_id = static_cast<std::uint32_t>(0x183 + i);
    joint.drive.rated_torque_Nm = 28.0;
    joint.drive.range.torque_Nm = 28.0 * 32.767;
    joint.drive.counts_per_turn = 65536;
    joint.drive.actuator.lag_s = 5e-4;
  }
  JointConfig& elastic = robot.joints[1];
  elastic.link_encoder.present = true;
  elastic.link_encoder.bits = 18;
  elastic.torque_sensor.present = true;
  elastic.torque_loop = {4.0, 4000.0, 1e-4};
  elastic.transmission.kind = TransmissionKind::kElastic;
  elastic.transmission.spring.stiffness_Nm_per_rad = 5000.0;
  elastic.transmission.damping_Nms_per_rad = 2.0;
  for (JointConfig& joint : robot.joints)
    joint.drive.frames = protocol_named("cia402").frames(joint, fd);
  return robot;
}

class Cia402Arm : public DrivenArm {
 public:
  explicit Cia402Arm(const Robot& from = cia402_robot()) : DrivenArm(from) {
    for (const JointConfig& joint : robot.joints)
      motors.emplace_back(joint, robot.buses[static_cast<std::size_t>(joint.drive.bus)].fd);
  }

  void answer() override {
    CanFrame frame;
    for (std::size_t b = 0; b < motor_ends.size(); ++b) {
      sent.clear();
      while (motor_ends[b]->receive(std::span(&frame, 1)) == 1) {
        sent.push_back(text(frame));
        for (FakeCia402& motor : motors) {
          if (motor.config.drive.bus != static_cast<int>(b)) continue;
          for (const CanFrame& reply : motor.handle(frame)) motor_ends[b]->send(reply);
        }
      }
      if (on_bus) on_bus(static_cast<int>(b), sent);
    }
  }

  bool start(int most = 200) {
    return run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP, most);
  }

  std::vector<FakeCia402> motors;
  std::vector<std::string> sent;  ///< by the driver in this cycle, on one bus
  std::function<void(int, const std::vector<std::string>&)> on_bus;
};

}  // namespace limber::testing
