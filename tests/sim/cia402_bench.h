// An emulated CiA 402 drive as node 3, and somebody who talks to it in candump's notation.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/protocols/cia402_pdos.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "sim/nodes/cia402_node.h"
#include "tests/sim/test_arms.h"
#include "tests/support/frame_text.h"

namespace limber::testing {

/// Rated torque 28 N m, 2 N m/A, 14 bits, peak 84 N m; elastic, 5000 N m/rad and 2 N m s/rad.
inline JointConfig cia402_joint() {
  JointConfig joint = joint_config(2, JointType::kRevolute, 0.2);
  joint.drive.protocol = &protocol_named("cia402");
  joint.drive.motor = "bench motor";
  joint.drive.command_id = 0x203;
  joint.drive.reply_id = 0x183;
  joint.drive.rated_torque_Nm = 28.0;
  joint.drive.torque_constant_Nm_per_A = 2.0;
  joint.drive.peak_torque_Nm = 84.0;
  joint.drive.counts_per_turn = 16384;
  joint.drive.short_circuit_damping_Nms = 0.7;
  joint.transmission.kind = TransmissionKind::kElastic;
  joint.transmission.spring.stiffness_Nm_per_rad = 5000.0;
  joint.transmission.damping_Nms_per_rad = 2.0;
  return joint;
}

inline JointConfig with_sensors(JointConfig joint, double inertia_ratio = 1.0) {
  joint.link_encoder.present = true;
  joint.link_encoder.bits = 16;
  joint.torque_sensor.present = true;
  joint.torque_loop.inertia_ratio = inertia_ratio;
  return joint;
}

class Cia402Bench {
 public:
  static constexpr std::int64_t kMs = 1'000'000;

  explicit Cia402Bench(const JointConfig& config = cia402_joint(), bool fd = false)
      : node(std::make_unique<sim::Cia402Node>(config, fd)) {
    advance(0);
    heard();  // boot-up
  }

  /// The answer, or "none". Frames longer than eight bytes are not for here.
  std::string send(const std::string& candump) {
    CanFrame reply;
    return node->receive(parse(candump), joint, now, &reply) ? text(reply) : "none";
  }
  /// What the node says unasked, one behind the other.
  std::string heard() {
    std::string all;
    CanFrame frame;
    while (node->next_frame(&frame)) all += (all.empty() ? "" : " ") + text(frame);
    return all;
  }
  void advance(std::int64_t ns) {
    now += ns;
    node->update(joint, now);
  }
  /// Milliseconds, one by one.
  void wait(int ms) {
    for (int i = 0; i < ms; ++i) advance(kMs);
  }

  // SDO by value; the bits of negative numbers and floats.
  std::string write(const canopen::Object& object, std::uint32_t value) {
    CanFrame reply;
    const bool answered =
        node->receive(canopen::encode_sdo_write(object, value, 3), joint, now, &reply);
    return answered ? text(reply) : "none";
  }
  /// The abort code of a write, 0 if it was done.
  std::uint32_t refusal(const canopen::Object& object, std::uint32_t value) {
    CanFrame reply;
    canopen::SdoMessage answer;
    if (!node->receive(canopen::encode_sdo_write(object, value, 3), joint, now, &reply) ||
        !canopen::decode_sdo_answer(reply, 3, &answer))
      return ~0U;
    return answer.kind == canopen::SdoKind::kAbort ? answer.value : 0;
  }
  /// The value's bits, or the abort code.
  std::uint32_t read(canopen::ObjectId object) {
    CanFrame reply;
    canopen::SdoMessage answer;
    if (!node->receive(canopen::encode_sdo_read(object, 3), joint, now, &reply) ||
        !canopen::decode_sdo_answer(reply, 3, &answer))
      return ~0U;
    return answer.value;
  }
  std::uint32_t read(const canopen::Object& object) { return read(object.id); }

  /// Identifier, objects and type of a PDO, then on.
  void map(std::uint16_t communication, std::uint32_t id, std::span<const canopen::Object> objects,
           std::uint8_t type) {
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    write(canopen::pdo_cob_id(communication), id | canopen::kPdoDisabled);
    write(canopen::pdo_mapped_count(mapping), 0);
    int count = 0;
    for (const canopen::Object& object : objects)
      write(canopen::pdo_mapped(mapping, ++count), object.mapping());
    write(canopen::pdo_mapped_count(mapping), static_cast<std::uint32_t>(count));
    write(canopen::pdo_type(communication), type);
    write(canopen::pdo_cob_id(communication), id);
  }
  /// Mode, synchronous RPDO1, start, and on to operation enabled.
  void enable(int watchdog_ms = 20) {
    write(cia402::kMode, 10);
    map(canopen::kRpdoCommunication, 0x203, cia402::command_objects(), 1);
    write(canopen::pdo_event_timer_ms(canopen::kRpdoCommunication),
          static_cast<std::uint32_t>(watchdog_ms));
    send("000#0103");
    wait(2);
    for (const char* word : {"203#06000000", "203#07000000", "203#0F000000"}) {
      send(word);
      send("080#");
    }
  }
  void command(std::int16_t permille) {
    CanFrame reply;
    node->receive(cia402::encode_command({cia402::kEnableOperation, permille}, 0x203, false), joint,
                  now, &reply);
  }
  double torque() const { return node->law().torque(joint.theta, joint.theta_dot); }

  std::unique_ptr<sim::Cia402Node> node;
  sim::JointReading joint;
  std::int64_t now = 0;
};

}  // namespace limber::testing
