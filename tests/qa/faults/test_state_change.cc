// A changed reply holds what was added, everything else as it was, in each family's own bytes.
#include <gtest/gtest.h>

#include <numbers>

#include "drivers/protocols/cia402_pdos.h"
#include "drivers/protocols/cubemars.h"
#include "drivers/protocols/mit.h"
#include "drivers/protocols/moteus.h"
#include "drivers/protocols/moteus_frame.h"
#include "drivers/protocols/odrive.h"
#include "qa/faults/state_change.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber::test_state_change {
namespace {

using faults::with_motion;

constexpr double kTurn = 2.0 * std::numbers::pi;

JointConfig joint_with(std::string_view protocol) {
  JointConfig joint;
  joint.drive.protocol = &protocol_named(protocol);
  joint.drive.reply_id = 0x181;
  return joint;
}

// 12.5 rad in 16 bits: 0.5 rad are 1310.7 counts; 30 rad/s in 12: 3 rad/s are 204.75.
TEST(StateChange, Damiao) {
  const JointConfig joint = joint_with("damiao_mit");
  const mit::Reply state{1, mit::DriveError::kEnabled, 1.0, 2.0, 3.0, 40, 50};
  CanFrame frame = mit::encode_reply(state, joint.drive.range, 0x11, false, mit::Quantiser::kRound);
  frame.timestamp_ns = 7;
  const CanFrame changed = with_motion(frame, joint, false, {0.5, 3.0});
  mit::Reply read;
  ASSERT_TRUE(mit::decode_reply(changed, joint.drive.range, &read));
  EXPECT_NEAR(read.position_rad, 1.5, 25.0 / 65535);
  EXPECT_NEAR(read.velocity_rad_per_s, 5.0, 60.0 / 4095);
  EXPECT_NEAR(read.torque_Nm, 3.0, 20.0 / 4095);
  EXPECT_EQ(read.error, mit::DriveError::kEnabled);
  EXPECT_EQ(read.rotor_temperature_degC, 50);
  EXPECT_EQ(changed.id, 0x11U);
  EXPECT_EQ(changed.timestamp_ns, 7);
}

TEST(StateChange, Cubemars) {
  JointConfig joint = joint_with("cubemars");
  joint.drive.board = cubemars::kV2;
  joint.drive.command_id = 3;
  const CanFrame frame =
      cubemars::encode_state({1.0, 2.0, 3.0, 40, 2}, joint.drive, mit::Quantiser::kRound);
  const CanFrame changed = with_motion(frame, joint, false, {0.5, 3.0});
  cubemars::State read;
  ASSERT_TRUE(cubemars::decode_state(changed, joint.drive, &read));
  EXPECT_NEAR(read.position_rad, 1.5, 25.0 / 65535);
  EXPECT_NEAR(read.velocity_rad_per_s, 5.0, 60.0 / 4095);
  EXPECT_NEAR(read.torque_Nm, 3.0, 20.0 / 4095);
  EXPECT_EQ(read.temperature_degC, 40);
  EXPECT_EQ(read.error, 2);
  CanFrame of_another = frame;
  of_another.data[0] = 4;
  EXPECT_EQ(with_motion(of_another, joint, false, {0.5, 3.0}).data, of_another.data);
}

// Geared 8 to 1: half a turn of the joint is four of the motor.
TEST(StateChange, Odrive) {
  JointConfig joint = joint_with("odrive");
  joint.drive.command_id = odrive::id_of(3, odrive::Message::kTorque);
  joint.drive.gear_ratio = 8.0;
  const CanFrame frame = odrive::encode(3, odrive::Message::kEstimates, 1.0F, -2.0F);
  const CanFrame changed =
      with_motion(frame, joint, false, {std::numbers::pi, 2.0 * std::numbers::pi});
  EXPECT_EQ(changed.id, frame.id);
  EXPECT_NEAR(odrive::field<float>(changed, 0), 5.0, 1e-6);
  EXPECT_NEAR(odrive::field<float>(changed, 4), 6.0, 1e-6);
  const CanFrame torques = odrive::encode(3, odrive::Message::kTorques, 1.0F, -2.0F);
  EXPECT_EQ(with_motion(torques, joint, false, {0.5, 3.0}).data, torques.data);
}

TEST(StateChange, Moteus) {
  using moteus::Type;
  const auto number = [](moteus::Register reg) { return static_cast<std::uint16_t>(reg); };
  const JointConfig joint = joint_with("moteus");
  moteus::FrameWriter writer(0x100);
  const double measured[] = {10.0, 0.25, 0.0, 1.5, 0.1};
  const double health[] = {30.0, 0.0};
  ASSERT_TRUE(writer.reply(Type::kFloat, number(moteus::Register::kMode), measured));
  ASSERT_TRUE(writer.reply(Type::kFloat, number(moteus::Register::kTemperature), health));
  moteus::State read;
  ASSERT_TRUE(
      moteus::decode_state(with_motion(writer.frame(), joint, true, {kTurn / 8, kTurn}), &read));
  EXPECT_NEAR(read.position_turns, 0.375, 1e-6);
  EXPECT_NEAR(read.velocity_turns_per_s, 1.0, 1e-6);
  EXPECT_NEAR(read.torque_Nm, 1.5, 1e-6);
  EXPECT_EQ(read.mode, moteus::Mode::kPosition);
}

// Position in TPDO1, velocity in TPDO2, 16384 counts a turn: 0x181#2702 00000000 becomes
// 0x181#2702 00080000 for an eighth of a turn.
TEST(StateChange, Cia402InSeveralFrames) {
  const JointConfig joint = joint_with("cia402");
  const cia402::StateLayout layout;
  const cia402::DriveState state{.statusword = 0x0227, .torque_permille = 5};
  const auto changed = [&](int k) {
    const CanFrame frame = cia402::encode_state(state, cia402::state_objects(layout, k),
                                                canopen::tpdo_id(k, 1), false);
    return with_motion(frame, joint, false, {kTurn / 8, kTurn});
  };
  const CanFrame first = changed(0);
  ASSERT_EQ(first.length, 6);
  const std::uint8_t bytes[] = {0x27, 0x02, 0x00, 0x08, 0x00, 0x00};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(first.data[i], bytes[i]) << i;
  cia402::DriveState read;
  ASSERT_TRUE(cia402::decode_state(changed(1), cia402::state_objects(layout, 1), &read));
  EXPECT_EQ(read.velocity_counts_per_s, 16384);
  EXPECT_EQ(read.torque_permille, 5);
}

TEST(StateChange, WhatHoldsNoStateStays) {
  CanFrame frame;
  frame.id = 0x7A1;
  frame.length = 3;
  for (const auto protocol : {"damiao_mit", "moteus", "cia402"}) {
    const CanFrame same = with_motion(frame, joint_with(protocol), false, {1.0, 1.0});
    EXPECT_EQ(same.id, 0x7A1U);
    EXPECT_EQ(same.length, 3);
  }
}

}  // namespace
}  // namespace limber::test_state_change
