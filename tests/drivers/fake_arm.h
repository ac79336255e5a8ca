// Motors for the driver's tests: a few lines each that read and write the bytes themselves, so that
// neither the protocol library nor the simulator can hide a mistake of the driver.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <vector>

#include "common/config_error.h"
#include "drivers/arm_driver.h"
#include "drivers/can/memory_bus.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber::testing {

/// The numbers in a command frame.
struct RawCommand {
  int p = 0, v = 0, kp = 0, kd = 0, t = 0;
};

inline RawCommand raw_command(const CanFrame& f) {
  const auto& d = f.data;
  return {d[0] << 8 | d[1], d[2] << 4 | d[3] >> 4, (d[3] & 15) << 8 | d[4], d[5] << 4 | d[6] >> 4,
          (d[6] & 15) << 8 | d[7]};
}

inline bool is_special(const CanFrame& f, int last = -1) {
  for (int i = 0; i < 7; ++i) {
    if (f.data[static_cast<std::size_t>(i)] != 0xFF) return false;
  }
  return last < 0 ? f.data[7] >= 0xFB && f.data[7] <= 0xFE : f.data[7] == last;
}

/// One Damiao-like drive: registers, enabled state, a reply to each frame with the state before it.
class FakeMotor {
 public:
  explicit FakeMotor(const DriveConfig& drive) : drive_(drive) {
    set_float(21, drive.range.position_rad);
    set_float(22, drive.range.velocity_rad_per_s);
    set_float(23, drive.range.torque_Nm);
    registers[9] = 0;
    registers[10] = 2;
  }

  /// The answer to a frame, if it is for this motor; nothing if silent.
  bool handle(const CanFrame& frame, CanFrame* reply) {
    const bool for_register = frame.id == 0x7FF && frame.data[0] == drive_.command_id;
    if (frame.extended || (frame.id != drive_.command_id && !for_register)) return false;
    const bool reads = for_register && frame.data[2] == 0x33;
    (reads && arm_on ? questions : frames).push_back(frame);
    *reply = frame;  // FD flags as in the request
    reply->id = drive_.reply_id;
    if (for_register && frame.data[2] != 0xCC) {
      answer_register(frame, reply);
    } else {
      write_state(reply);
      if (!for_register) obey(frame);
    }
    return !silent;
  }

  void set_float(int reg, double value) {
    const auto narrow = static_cast<float>(value);
    std::memcpy(&registers[reg], &narrow, 4);
  }
  double torque_of(int raw) const {
    return -drive_.range.torque_Nm + raw * 2.0 * drive_.range.torque_Nm / 4095.0;
  }
  const CanFrame& last() const { return frames.back(); }
  const DriveConfig& drive() const { return drive_; }

  std::map<int, std::uint32_t> registers;
  std::vector<CanFrame> frames;     ///< all it ever received, but for
  std::vector<CanFrame> questions;  ///< registers that are read while the arm is ON
  bool arm_on = false;
  int error = 0;       ///< status nibble: 0 disabled, 1 enabled, 8 and more: fault
  double angle = 0.0;  ///< drive side
  double speed = 0.0;
  double torque = 0.0;
  int mos_degC = 30;
  int rotor_degC = 35;
  bool silent = false;    ///< hears and obeys, does not answer
  bool obedient = true;   ///< false: ignores enable
  bool stubborn = false;  ///< ignores disable
  bool ignores_writes = false;

 private:
  static int truncated(double value, double range, int top) {
    const double count = (value + range) * top / (2.0 * range);
    return count < 0 ? 0 : count > top ? top : static_cast<int>(count);
  }

  void write_state(CanFrame* reply) const {
    const int p = truncated(angle, drive_.range.position_rad, 65535);
    const int v = truncated(speed, drive_.range.velocity_rad_per_s, 4095);
    const int t = truncated(torque, drive_.range.torque_Nm, 4095);
    const int bytes[8] = {error << 4 | static_cast<int>(drive_.command_id & 15),
                          p >> 8,
                          p & 255,
                          v >> 4,
                          (v & 15) << 4 | t >> 8,
                          t & 255,
                          mos_degC,
                          rotor_degC};
    for (std::size_t i = 0; i < 8; ++i) reply->data[i] = static_cast<std::uint8_t>(bytes[i]);
  }

  void answer_register(const CanFrame& frame, CanFrame* reply) {
    std::uint32_t value = 0;
    std::memcpy(&value, &frame.data[4], 4);
    if (frame.data[2] == 0x55 && !ignores_writes) registers[frame.data[3]] = value;
    if (frame.data[2] == 0x33) std::memcpy(&reply->data[4], &registers[frame.data[3]], 4);
  }

  void obey(const CanFrame& frame) {
    if (is_special(frame, 0xFB) && error >= 8) error = 0;
    if (is_special(frame, 0xFC) && error == 0 && obedient) error = 1;
    if (is_special(frame, 0xFD) && !stubborn) error = 0;
  }

  DriveConfig drive_;
};

/// `n` joints on one FD bus (joint i: id i + 1); every second one counts the other way round and
/// has its zero elsewhere. 1 kHz, 8 N m, 0.5 N m per cycle, 5 rad/s, +-2 rad.
inline Robot test_robot(int n, int num_buses = 1) {
  Robot robot;
  robot.name = "test";
  robot.has_drives = true;
  for (int b = 0; b < num_buses; ++b) {
    BusConfig bus;
    bus.name = "can" + std::to_string(b);
    bus.fd = true;
    robot.buses.push_back(bus);
  }
  for (int i = 0; i < n; ++i) {
    JointConfig joint;
    joint.drive.protocol = &protocol_named("damiao_mit");
    joint.name = "joint" + std::to_string(i + 1);
    joint.position_min = -2.0;
    joint.position_max = 2.0;
    joint.velocity_limit = 5.0;
    joint.torque_limit_Nm = 8.0;
    joint.torque_rate_limit_Nm_per_s = 500.0;
    joint.drive.bus = i % num_buses;
    joint.drive.command_id = static_cast<std::uint32_t>(i + 1);
    joint.drive.reply_id = static_cast<std::uint32_t>(i + 0x11);
    joint.drive.sign = i % 2 == 0 ? 1.0 : -1.0;
    joint.drive.offset_rad = i % 2 == 0 ? 0.0 : 0.3;
    joint.drive.torque_constant_Nm_per_A = 0.5;
    joint.drive.hold_kp_Nm_per_rad = 50.0;
    joint.drive.hold_kd_Nms_per_rad = 1.0;
    robot.joints.push_back(joint);
  }
  return robot;
}

/// Gives the joint a second motor like its first, which answers to 5.
inline void add_second_motor(JointConfig* joint) {
  joint->has_antagonist = true;
  joint->antagonist = joint->drive;
  joint->antagonist.command_id = 5;
  joint->antagonist.reply_id = 0x15;
}

/// A driver on in-memory buses, and the shortest controller there is. What answers it is up to the
/// arm.
class DrivenArm {
 public:
  explicit DrivenArm(const Robot& from, bool lockstep = false, int bridged_cycles = 2)
      : robot(from) {
    std::vector<CanBus*> ends;
    for (std::size_t b = 0; b < robot.buses.size(); ++b) {
      memory.push_back(std::make_unique<MemoryBus>());
      driver_ends.push_back(memory.back()->attach());
      motor_ends.push_back(memory.back()->attach());
      ends.push_back(driver_ends.back().get());
    }
    driver = std::make_unique<ArmDriver>(robot, ends,
                                         ArmDriverOptions{kSession, lockstep, bridged_cycles});
    driver->fill_status(&status);
    command.session = kSession;
    command.controller = kController;
    command.num_joints = static_cast<std::int16_t>(robot.joints.size());
  }
  DrivenArm(DrivenArm&&) = default;
  virtual ~DrivenArm() = default;

  /// Motors answer everything that waits.
  virtual void answer() = 0;

  /// transmit, replies, finish_cycle.
  const joint_state_t& half_cycle() {
    ++cycle;
    driver->transmit(cycle * 1'000'000, cycle * 1'000'000);
    answer();
    driver->poll();
    state = &driver->finish_cycle();
    return *state;
  }
  /// Answers the present state with `command`.
  int answer_state() {
    command.state_seq = state->seq;
    command.time_ns = state->time_ns;
    return driver->accept(command);
  }
  int cycle_with(int request) {
    half_cycle();
    command.request = static_cast<std::int8_t>(request);
    return answer_state();
  }
  /// Runs with the request until the drives are in a state; false after `most` cycles.
  bool run_until(int drive_state, int request, int most = 200) {
    for (int i = 0; i < most; ++i) {
      cycle_with(request);
      if (state->drive_state == drive_state) return true;
    }
    return false;
  }
  bool switch_on() {
    return run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP) &&
           run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON);
  }
  const driver_status_t& read_status() {
    driver->fill_status(&status);
    return status;
  }

  static constexpr std::int64_t kSession = 42;
  static constexpr std::int64_t kController = 7;

  Robot robot;
  std::vector<std::unique_ptr<MemoryBus>> memory;
  std::vector<std::unique_ptr<CanBus>> driver_ends;
  std::vector<std::unique_ptr<CanBus>> motor_ends;
  std::unique_ptr<ArmDriver> driver;
  const joint_state_t* state = nullptr;
  joint_command_t command{};
  driver_status_t status{};
  std::int64_t cycle = -1;
};

/// With fake motors: one for every joint, and then the second ones of joints that have two.
class FakeArm : public DrivenArm {
 public:
  explicit FakeArm(const Robot& from, bool lockstep = false, int bridged_cycles = 2)
      : DrivenArm(from, lockstep, bridged_cycles) {
    for (const JointConfig& joint : robot.joints) motors.emplace_back(joint.drive);
    for (const JointConfig& joint : robot.joints) {
      if (joint.has_antagonist) motors.emplace_back(joint.antagonist);
    }
  }

  void answer() override {
    CanFrame frame;
    CanFrame reply;
    for (FakeMotor& motor : motors)
      motor.arm_on = state != nullptr && state->drive_state == joint_state_t::DRIVE_ON;
    for (std::size_t b = 0; b < motor_ends.size(); ++b) {
      while (motor_ends[b]->receive(std::span(&frame, 1)) == 1) {
        for (FakeMotor& motor : motors) {
          if (motor.drive().bus == static_cast<int>(b) && motor.handle(frame, &reply))
            motor_ends[b]->send(reply);
        }
      }
    }
  }

  void set_angle(int joint, double q) {
    const DriveConfig& drive = robot.joints[static_cast<std::size_t>(joint)].drive;
    motors[static_cast<std::size_t>(joint)].angle = drive.sign * q + drive.offset_rad;
  }
  void set_speed(int joint, double v) {
    motors[static_cast<std::size_t>(joint)].speed =
        robot.joints[static_cast<std::size_t>(joint)].drive.sign * v;
  }

  std::vector<FakeMotor> motors;
};

}  // namespace limber::testing
