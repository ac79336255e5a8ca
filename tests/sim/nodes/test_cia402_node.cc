// The emulated CiA 402 drive, node 3: its states, torques and faults.
#include <gtest/gtest.h>

#include <cmath>
#include <limber/scenario_event_t.hpp>
#include <numbers>
#include <random>
#include <string>

#include "drivers/protocols/mit.h"
#include "tests/sim/cia402_bench.h"
#include "tools/allocations/allocations.h"

namespace limber::sim::test_cia402_node {
namespace {

using canopen::SdoAbort;
using cia402::State;
using limber::testing::cia402_joint;
using limber::testing::Cia402Bench;
using limber::testing::with_sensors;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::uint32_t code(SdoAbort abort) { return static_cast<std::uint32_t>(abort); }
std::uint32_t bits(double value) { return mit::float_bits(static_cast<float>(value)); }

// --- states ---

TEST(Cia402Node, WorkedControlwordsEnableIt) {
  Cia402Bench bench;
  bench.write(cia402::kMode, 10);
  bench.wait(2);
  EXPECT_EQ(bench.read(cia402::kStatusword), 0x0250U);
  const std::pair<const char*, std::uint32_t> words[] = {
      {"603#2B40600006000000", 0x0231},
      {"603#2B40600007000000", 0x0233},
      {"603#2B4060000F000000", 0x1637},
  };
  for (const auto& [request, statusword] : words) {
    EXPECT_EQ(bench.send(request), "583#6040600000000000");
    EXPECT_EQ(bench.read(cia402::kStatusword), statusword);
  }
  EXPECT_TRUE(bench.node->enabled());
}

/// Brings a drive into a state.
void enter(Cia402Bench* bench, State state) {
  bench->write(cia402::kMode, 10);
  bench->wait(2);
  bench->joint.theta_dot = 1.0;  // a quick stop goes on
  const auto go = [bench](std::initializer_list<std::uint32_t> words) {
    for (const std::uint32_t word : words) bench->write(cia402::kControlword, word);
  };
  switch (state) {
    case State::kReadyToSwitchOn:
      return go({6});
    case State::kSwitchedOn:
      return go({6, 7});
    case State::kOperationEnabled:
      return go({6, 7, 15});
    case State::kQuickStopActive:
      return go({6, 7, 15, 2});
    case State::kFaultReactionActive:
    case State::kFault:
      bench->node->inject(scenario_event_t::FAULT_DRIVE_ERROR, bench->joint, bench->now);
      if (state == State::kFault) bench->wait(1);
      return;
    default:
      return;
  }
}

TEST(Cia402Node, EveryCommandInEveryState) {
  // Where a controlword leads from: disabled, ready, switched on, enabled, quick stop (605Ah = 2
  // and 6), fault reaction, fault.
  const std::pair<std::uint32_t, const char*> commands[] = {
      {0x06, "RRRRQQXF"}, {0x07, "DSSSQQXF"}, {0x0F, "DEEEQEXF"}, {0x00, "DDDDDDXF"},
      {0x0D, "DDDDDDXF"}, {0x02, "DDDQQQXF"}, {0x03, "DDDQQQXF"}, {0x80, "DRSEQQXD"},
  };
  const State from[] = {State::kSwitchOnDisabled,    State::kReadyToSwitchOn,
                        State::kSwitchedOn,          State::kOperationEnabled,
                        State::kQuickStopActive,     State::kQuickStopActive,
                        State::kFaultReactionActive, State::kFault};
  for (const auto& [word, expected] : commands) {
    for (int i = 0; i < 8; ++i) {
      Cia402Bench bench;
      bench.write(cia402::kQuickStopOption, i == 5 ? 6 : 2);
      enter(&bench, from[i]);
      ASSERT_EQ(bench.node->state(), from[i]);
      bench.write(cia402::kControlword, word);
      EXPECT_EQ("NDRSEQXF"[static_cast<int>(bench.node->state())], expected[i])
          << "controlword " << word << " in " << cia402::name_of(from[i]);
    }
  }
}

TEST(Cia402Node, AFaultResetIsAnEdge) {
  Cia402Bench bench;
  enter(&bench, State::kOperationEnabled);
  bench.write(cia402::kControlword, 0x8F);
  bench.node->inject(scenario_event_t::FAULT_DRIVE_ERROR, bench.joint, bench.now);
  bench.wait(1);
  bench.write(cia402::kControlword, 0x80);
  EXPECT_EQ(bench.node->state(), State::kFault);
  bench.write(cia402::kControlword, 0x00);
  bench.write(cia402::kControlword, 0x80);
  EXPECT_EQ(bench.node->state(), State::kSwitchOnDisabled);
}

TEST(Cia402Node, AQuickStopBrakesAndEndsAtRest) {
  Cia402Bench bench;
  enter(&bench, State::kQuickStopActive);
  EXPECT_EQ(bench.node->law().passive_damping, 0.7);
  EXPECT_EQ(bench.torque(), 0.0);
  bench.wait(100);
  EXPECT_EQ(bench.node->state(), State::kQuickStopActive);
  EXPECT_EQ(bench.read(cia402::kStatusword), 0x0217U);
  bench.joint.theta_dot = 0.001;
  bench.wait(1);
  EXPECT_EQ(bench.node->state(), State::kSwitchOnDisabled);
  EXPECT_EQ(bench.node->law().passive_damping, 0.0);

  Cia402Bench at_once;
  at_once.write(cia402::kQuickStopOption, 0);
  enter(&at_once, State::kOperationEnabled);
  at_once.write(cia402::kControlword, 2);
  EXPECT_EQ(at_once.node->state(), State::kSwitchOnDisabled);
}

TEST(Cia402Node, TheModeInForceFollowsTheOneWanted) {
  const JointConfig joint = cia402_joint();
  for (const std::int64_t delay_ms : {2, 7}) {
    Cia402Bench bench;
    bench.node = std::make_unique<Cia402Node>(joint, false, delay_ms * Cia402Bench::kMs);
    bench.advance(0);
    bench.write(cia402::kMode, 10);
    bench.wait(static_cast<int>(delay_ms) - 1);
    EXPECT_EQ(bench.read(cia402::kModeInForce), 0U);
    bench.wait(1);
    EXPECT_EQ(bench.read(cia402::kModeInForce), 10U);
  }
}

TEST(Cia402Node, NoTorqueWithoutTheMode) {
  Cia402Bench bench;
  for (const std::uint32_t word : {6U, 7U, 15U}) bench.write(cia402::kControlword, word);
  bench.write(cia402::kTargetTorque, 100);
  EXPECT_EQ(bench.node->state(), State::kOperationEnabled);
  EXPECT_FALSE(bench.node->enabled());
  EXPECT_EQ(bench.torque(), 0.0);
  EXPECT_EQ(bench.read(cia402::kStatusword), 0x0237U);
}

// --- torque and what is sensed ---

TEST(Cia402Node, TheTorqueStartsFromZero) {
  Cia402Bench bench;
  enter(&bench, State::kSwitchedOn);
  bench.write(cia402::kTargetTorque, 500);
  EXPECT_EQ(bench.torque(), 0.0);
  bench.write(cia402::kControlword, 15);
  EXPECT_EQ(bench.torque(), 0.0);
  bench.write(cia402::kTargetTorque, 500);
  EXPECT_DOUBLE_EQ(bench.torque(), 14.0);
  bench.write(cia402::kControlword, 7);
  bench.write(cia402::kControlword, 15);
  EXPECT_EQ(bench.torque(), 0.0);
}

TEST(Cia402Node, TargetAndOffsetWithinTheLimit) {
  Cia402Bench bench;
  EXPECT_EQ(bench.read(cia402::kMaxTorque), 3000U);  // 84 N m
  enter(&bench, State::kOperationEnabled);
  bench.write(cia402::kTargetTorque, 500);
  bench.write(cia402::kTorqueOffset, static_cast<std::uint16_t>(-100));
  EXPECT_DOUBLE_EQ(bench.torque(), 11.2);
  EXPECT_EQ(bench.read(cia402::kTorqueDemand), 400U);
  EXPECT_EQ(bench.read(cia402::kStatusword), 0x1637U);
  bench.write(cia402::kMaxTorque, 300);
  EXPECT_DOUBLE_EQ(bench.torque(), 8.4);
  EXPECT_EQ(bench.read(cia402::kTorqueDemand), 300U);
  EXPECT_EQ(bench.read(cia402::kStatusword), 0x1E37U);  // internal limit
  bench.write(cia402::kTargetTorque, static_cast<std::uint16_t>(-32768));
  EXPECT_DOUBLE_EQ(bench.torque(), -8.4);
  bench.write(cia402::kMaxTorque, 65535);
  EXPECT_DOUBLE_EQ(bench.torque(), -84.0);  // the peak
}

TEST(Cia402Node, ScalesAreThoseOfTheDescription) {
  Cia402Bench bench(with_sensors(cia402_joint()));
  EXPECT_EQ(bench.read(cia402::kRatedTorque_mNm), 28000U);
  EXPECT_EQ(bench.read(cia402::kRatedCurrent_mA), 14000U);
  EXPECT_EQ(bench.read(cia402::kEncoderCounts), 16384U);
  EXPECT_EQ(bench.read(canopen::ObjectId{0x608F, 2}), 1U);
  EXPECT_EQ(bench.read(cia402::kLinkEncoderCounts), 65536U);
  EXPECT_EQ(bench.read(cia402::kSupportedModes), 0x200U);
  EXPECT_EQ(bench.read(cia402::kSpringStiffness_Nm_per_rad), bits(5000.0));
  EXPECT_EQ(bench.read(cia402::kSpringDamping_Nms_per_rad), bits(2.0));
  EXPECT_EQ(bench.read(cia402::kTorqueLoopRate_Hz), 4000U);
}

TEST(Cia402Node, CountsThatAreNoPowerOfTwo) {
  JointConfig joint = cia402_joint();
  joint.drive.counts_per_turn = 16384.0 * 2401.0 / 15.0;
  Cia402Bench bench(joint);
  EXPECT_EQ(bench.read(cia402::kEncoderCounts), 39337984U);  // in 15 turns
  EXPECT_EQ(bench.read(cia402::kEncoderTurns), 15U);
  EXPECT_EQ(bench.read(cia402::kGearMotorTurns), 1U);
  EXPECT_EQ(bench.read(cia402::kGearJointTurns), 1U);
  bench.joint.theta = 0.5 * kTurn;
  EXPECT_EQ(bench.read(cia402::kPosition), 1311266U);  // 1311266.13
}

TEST(Cia402Node, DescribesItself) {
  Cia402Bench bench;
  EXPECT_EQ(bench.send("603#4014100000000000"), "583#4314100083000000");  // emergencies on 083
  EXPECT_EQ(bench.send("603#4018100000000000"), "583#4F18100004000000");
  EXPECT_EQ(bench.send("603#4018100100000000"), "583#43181001626D696C");  // "limb"
  EXPECT_EQ(bench.send("603#4018100400000000"), "583#4318100403000000");  // serial: the node
  EXPECT_EQ(bench.send("603#4009100000000000"), "583#4109100009000000");  // "simulated": segments
  EXPECT_EQ(bench.send("603#4000120000000000"), "583#4F00120002000000");
  EXPECT_EQ(bench.send("603#4000120100000000"), "583#4300120103060000");
  EXPECT_EQ(bench.read(cia402::kSupply_mV), 48000U);
  EXPECT_EQ(bench.read(cia402::kDigitalInputs), 0U);
  for (const cia402::Object& option : {cia402::kShutdownOption, cia402::kHaltOption}) {
    EXPECT_EQ(bench.refusal(option, 0), 0U);
    EXPECT_EQ(bench.refusal(option, 1), 0x06090031U);
  }
}

/// The whole TPDO as limber maps it.
cia402::DriveState state_of(Cia402Bench* bench, bool link_encoder) {
  const cia402::StateLayout layout = {.fd = true, .link_encoder = link_encoder};
  const auto objects = cia402::state_objects(layout, 0);
  bench->map(canopen::kTpdoCommunication, 0x183, objects, 1);
  bench->send("000#0103");
  CanFrame reply;
  EXPECT_TRUE(bench->node->receive(canopen::encode_sync(), bench->joint, bench->now, &reply));
  cia402::DriveState state;
  EXPECT_TRUE(cia402::decode_state(reply, objects, &state));
  return state;
}

TEST(Cia402Node, SensedInCountsAndThousandths) {
  Cia402Bench bench(with_sensors(cia402_joint()), true);
  bench.joint.theta = 0.30001 * kTurn;  // 4915.36 counts
  bench.joint.theta_dot = 0.5 * kTurn;
  bench.joint.q = -0.1 * kTurn;  // -6553.6 counts
  bench.joint.v = -0.25 * kTurn;
  bench.joint.joint_torque = 2.8;
  bench.joint.current_A = -7.0;
  const cia402::DriveState state = state_of(&bench, true);
  EXPECT_EQ(state.position_counts, 4915);
  EXPECT_EQ(state.velocity_counts_per_s, 8192);
  EXPECT_EQ(state.torque_permille, 100);
  EXPECT_EQ(state.current_permille, -500);
  EXPECT_EQ(state.link_position_counts, -6554);
  EXPECT_EQ(state.link_velocity_counts_per_s, -16384);
}

TEST(Cia402Node, WithoutATorqueSensorTorqueComesOfTheCurrent) {
  Cia402Bench bench(cia402_joint(), true);
  bench.joint.joint_torque = 2.8;
  bench.joint.current_A = -7.0;
  EXPECT_EQ(state_of(&bench, false).torque_permille, -500);
}

TEST(Cia402Node, SignAndOffset) {
  JointConfig joint = with_sensors(cia402_joint(), 2.0);
  joint.drive.sign = -1.0;
  joint.drive.offset_rad = 0.25 * kTurn;
  Cia402Bench bench(joint, true);
  bench.joint.theta = 0.1 * kTurn - 1e-9;
  bench.joint.q = 0.2 * kTurn - 1e-9;
  bench.joint.theta_dot = bench.joint.v = 0.5 * kTurn;
  bench.joint.joint_torque = 2.8;
  bench.joint.current_A = 7.0;
  const cia402::DriveState state = state_of(&bench, true);
  EXPECT_EQ(state.position_counts, 2457);        // 0.15 turns
  EXPECT_EQ(state.link_position_counts, 13107);  // 0.2: the link encoder counts as the joint does
  EXPECT_EQ(state.velocity_counts_per_s, -8192);
  EXPECT_EQ(state.link_velocity_counts_per_s, 32768);
  EXPECT_EQ(state.torque_permille, -100);
  EXPECT_EQ(state.current_permille, -500);
  enter(&bench, State::kOperationEnabled);
  bench.write(cia402::kTargetTorque, 100);
  bench.wait(100);
  // u = -2.8 and tau = 2.8 on the joint: 2 u - tau.
  EXPECT_NEAR(bench.torque(), 2.0 * -2.8 - 2.8, 1e-9);
}

// --- torque loop ---

TEST(Cia402Node, TorqueLoopIsClosedOnTheSensor) {
  Cia402Bench bench(with_sensors(cia402_joint(), 4.0));
  EXPECT_EQ(bench.node->loop_rate_hz(), 4000.0);
  enter(&bench, State::kOperationEnabled);
  bench.joint.joint_torque = 10.0;
  bench.wait(100);
  EXPECT_NEAR(bench.torque(), -30.0, 1e-9);
  bench.write(cia402::kTargetTorque, 100);  // at once
  EXPECT_NEAR(bench.torque(), 4.0 * 2.8 - 30.0, 1e-9);
  bench.write(cia402::kInertiaRatio, bits(1.0));
  EXPECT_NEAR(bench.torque(), 2.8, 1e-9);
}

TEST(Cia402Node, TorqueLoopIsWrittenWithinReason) {
  Cia402Bench bench(with_sensors(cia402_joint(), 4.0));
  EXPECT_EQ(bench.read(cia402::kInertiaRatio), bits(4.0));
  EXPECT_EQ(bench.refusal(cia402::kInertiaRatio, bits(0.5)), code(SdoAbort::kTooLow));
  EXPECT_EQ(bench.refusal(cia402::kInertiaRatio, bits(NAN)), code(SdoAbort::kValueRange));
  EXPECT_EQ(bench.refusal(cia402::kSpringStiffness_Nm_per_rad, 0), code(SdoAbort::kValueRange));
  EXPECT_EQ(bench.refusal(cia402::kSpringDamping_Nms_per_rad, 0), 0U);
  EXPECT_EQ(bench.refusal(cia402::kTorqueLoopRate_Hz, 8000), code(SdoAbort::kReadOnly));
}

TEST(Cia402Node, WithoutATorqueSensorThereIsNoLoop) {
  Cia402Bench bench;
  EXPECT_EQ(bench.node->loop_rate_hz(), 0.0);
  EXPECT_EQ(bench.read(cia402::kInertiaRatio), bits(1.0));
  EXPECT_EQ(bench.refusal(cia402::kInertiaRatio, bits(2.0)), code(SdoAbort::kReadOnly));
  EXPECT_EQ(bench.refusal(cia402::kSpringStiffness_Nm_per_rad, bits(1.0)),
            code(SdoAbort::kReadOnly));
}

TEST(Cia402Node, AFaultBrakesOrLetsGo) {
  Cia402Bench bench;
  EXPECT_EQ(bench.refusal(cia402::kFaultOption, 0), 0U);
  EXPECT_EQ(bench.refusal(cia402::kFaultOption, 1), code(SdoAbort::kValueRange));
  EXPECT_EQ(bench.refusal(cia402::kFaultOption, 2), 0U);
}

// --- lost connections ---

TEST(Cia402Node, AMissingRpdoIsAFault) {
  for (const auto reaction : {NodeWatchdogReaction::kDamp, NodeWatchdogReaction::kOff}) {
    JointConfig joint = cia402_joint();
    joint.drive.watchdog_reaction = reaction;
    Cia402Bench bench(joint);
    bench.enable(20);
    bench.command(100);
    bench.send("080#");
    bench.wait(20);
    EXPECT_DOUBLE_EQ(bench.torque(), 2.8);
    EXPECT_EQ(bench.heard(), "");
    bench.advance(1);
    EXPECT_EQ(bench.heard(), "083#5082110000000000");
    EXPECT_EQ(bench.torque(), 0.0);
    EXPECT_EQ(bench.node->law().passive_damping,
              reaction == NodeWatchdogReaction::kDamp ? 0.7 : 0.0);
    EXPECT_EQ(bench.node->state(), State::kFaultReactionActive);
    bench.wait(1);
    EXPECT_EQ(bench.node->state(), State::kFault);
    EXPECT_EQ(bench.read(cia402::kErrorCode), 0x8250U);
    bench.command(100);  // being back is not enough
    bench.send("080#");
    EXPECT_EQ(bench.node->state(), State::kFault);
    EXPECT_EQ(bench.heard(), "");
    for (const char* word : {"203#00000000", "203#80000000"}) {
      bench.send(word);
      bench.send("080#");
    }
    EXPECT_EQ(bench.heard(), "083#0000000000000000");
    EXPECT_EQ(bench.node->state(), State::kSwitchOnDisabled);
    EXPECT_EQ(bench.node->law().passive_damping, 0.0);
    EXPECT_EQ(bench.read(cia402::kErrorCode), 0U);
  }
}

TEST(Cia402Node, ReactionsToALostConnection) {
  const char states[] = "EFDQ";  // nothing, fault, disable voltage, quick stop
  for (std::uint32_t reaction = 0; reaction < 4; ++reaction) {
    Cia402Bench bench;
    bench.write(cia402::kConnectionLostOption, reaction);
    bench.enable(20);
    bench.joint.theta_dot = 1.0;
    bench.wait(22);
    EXPECT_EQ("NDRSEQXF"[static_cast<int>(bench.node->state())], states[reaction]);
    EXPECT_EQ(bench.heard(), "083#5082110000000000");
    bench.command(0);
    EXPECT_EQ(bench.heard(), reaction == 1 ? "" : "083#0000000000000000");
  }
}

TEST(Cia402Node, NoLongerOperationalIsLostToo) {
  for (const char* command : {"000#0203", "000#8003"}) {
    Cia402Bench bench;
    bench.enable();
    bench.send(command);
    bench.wait(1);
    EXPECT_EQ(bench.node->state(), State::kFault) << command;
    EXPECT_EQ(bench.torque(), 0.0);
  }
  Cia402Bench bench;
  bench.send("000#0103");
  bench.send("000#8003");  // not enabled: no harm done
  EXPECT_EQ(bench.node->state(), State::kSwitchOnDisabled);
  EXPECT_EQ(bench.heard(), "");
}

TEST(Cia402Node, ALostHeartbeatIsAFault) {
  Cia402Bench bench;
  bench.write(canopen::kConsumerHeartbeat, 0x007F0005);
  bench.enable();
  bench.send("77F#05");
  bench.wait(7);
  EXPECT_EQ(bench.node->state(), State::kFault);
  EXPECT_EQ(bench.heard(), "083#3081110000000000");
}

TEST(Cia402Node, AResetOfTheNodeStartsOver) {
  Cia402Bench bench;
  bench.enable();
  bench.command(100);
  bench.send("080#");
  bench.send("000#8103");
  bench.wait(1);
  EXPECT_EQ(bench.heard(), "703#00");
  EXPECT_EQ(bench.node->state(), State::kSwitchOnDisabled);
  EXPECT_EQ(bench.torque(), 0.0);
  EXPECT_EQ(bench.read(cia402::kMode), 0U);
}

// --- faults on demand ---

TEST(Cia402Node, DriveErrorIsAnOverCurrentThatLasts) {
  Cia402Bench bench;
  bench.enable(0);
  bench.node->inject(scenario_event_t::FAULT_DRIVE_ERROR, bench.joint,
                     bench.now + 10 * Cia402Bench::kMs);
  EXPECT_EQ(bench.heard(), "083#1023030000000000");
  EXPECT_EQ(bench.node->law().passive_damping, 0.0);  // the power stage itself has failed
  bench.wait(2);
  const auto reset = [&] {
    bench.write(cia402::kControlword, 0);
    bench.write(cia402::kControlword, 0x80);
    return bench.node->state();
  };
  EXPECT_EQ(reset(), State::kFault);
  bench.wait(9);
  EXPECT_EQ(bench.node->state(), State::kFault);
  EXPECT_EQ(reset(), State::kSwitchOnDisabled);
  EXPECT_EQ(bench.heard(), "083#0000000000000000");
}

// Bit 7 of the statusword; these drives report no temperature.
TEST(Cia402Node, HotDrivesWarn) {
  Cia402Bench bench;
  bench.enable();
  EXPECT_EQ(bench.read(cia402::kStatusword), 0x1637U);
  bench.node->inject(scenario_event_t::FAULT_HOT, bench.joint, bench.now + 10 * Cia402Bench::kMs);
  EXPECT_EQ(bench.read(cia402::kStatusword), 0x16B7U);
}

TEST(Cia402Node, SilentDrivesObey) {
  Cia402Bench bench;
  bench.write(canopen::kHeartbeatPeriod_ms, 5);
  bench.enable();
  bench.heard();
  bench.node->inject(scenario_event_t::FAULT_SILENT, bench.joint,
                     bench.now + 10 * Cia402Bench::kMs);
  bench.command(100);
  EXPECT_EQ(bench.send("080#"), "none");
  EXPECT_DOUBLE_EQ(bench.torque(), 2.8);
  EXPECT_EQ(bench.read(cia402::kStatusword), ~0U);  // no answer
  bench.wait(9);
  EXPECT_EQ(bench.heard(), "");
  bench.wait(2);
  EXPECT_EQ(bench.read(cia402::kStatusword), 0x1637U);
}

TEST(Cia402Node, FrozenEncoders) {
  Cia402Bench bench(with_sensors(cia402_joint()), true);
  bench.joint.theta = bench.joint.q = 0.1;
  bench.node->inject(scenario_event_t::FAULT_FROZEN_ENCODER, bench.joint,
                     bench.now + 10 * Cia402Bench::kMs);
  bench.joint.theta = bench.joint.q = 0.3;
  bench.joint.theta_dot = bench.joint.v = 1.0;
  cia402::DriveState state = state_of(&bench, true);
  EXPECT_EQ(state.position_counts, 260);  // 0.1 rad
  EXPECT_EQ(state.link_position_counts, 1043);
  EXPECT_EQ(state.velocity_counts_per_s, 0);
  EXPECT_EQ(state.link_velocity_counts_per_s, 0);
  bench.wait(10);
  state = state_of(&bench, true);
  EXPECT_EQ(state.position_counts, 782);
  EXPECT_EQ(state.velocity_counts_per_s, 2608);
}

TEST(Cia402Node, DroppedCommandsStarveTheWatchdog) {
  Cia402Bench bench;
  bench.map(canopen::kTpdoCommunication, 0x183, std::span(&cia402::kTorqueDemand, 1), 1);
  bench.enable(20);
  bench.command(100);
  bench.send("080#");
  bench.node->inject(scenario_event_t::FAULT_DROP_COMMANDS, bench.joint,
                     bench.now + 100 * Cia402Bench::kMs);
  EXPECT_EQ(bench.refusal(cia402::kTargetTorque, 0), code(SdoAbort::kCannotStore));
  for (int i = 0; i < 20; ++i) {
    bench.command(200);
    EXPECT_EQ(bench.send("080#"), "183#6400");  // answers with what it obeys: 100
    bench.wait(1);
  }
  bench.wait(1);
  EXPECT_EQ(bench.node->state(), State::kFaultReactionActive);
}

TEST(Cia402Node, WhateverComesTheTorqueIsFiniteAndWithinThePeak) {
  Cia402Bench bench(with_sensors(cia402_joint(), 4.0), true);
  bench.enable();
  std::minstd_rand random(402);
  const std::uint32_t ids[] = {0x000, 0x080, 0x203, 0x203, 0x303, 0x603, 0x603, 0x603, 0x77F};
  const std::uint16_t indices[] = {0x1400, 0x1600, 0x1800, 0x1A00, 0x1016, 0x2010, 0x6040,
                                   0x6060, 0x6071, 0x6072, 0x60B2, 0x6403, 0x605A, 0x6007};
  CanFrame frame, reply;
  int answers = 0;
  for (int i = 0; i < 200'000; ++i) {
    frame.id = ids[random() % std::size(ids)];
    frame.length = static_cast<std::uint8_t>(frame.id == 0x603 ? 8 : random() % 9);
    for (std::size_t k = 0; k < 8; ++k) frame.data[k] = static_cast<std::uint8_t>(random() >> 8U);
    if (frame.id == 0x603) {
      const std::uint16_t index = indices[random() % std::size(indices)];
      frame.data[1] = static_cast<std::uint8_t>(index);
      frame.data[2] = static_cast<std::uint8_t>(index >> 8U);
      frame.data[3] = static_cast<std::uint8_t>(frame.data[3] % 7);
    }
    // Seldom stopped or reset: then little would happen.
    if (frame.id == 0x000 && random() % 8 != 0) frame.data[0] = 1;
    bench.joint.joint_torque = static_cast<double>(random() % 2000) - 1000.0;
    answers += bench.node->receive(frame, bench.joint, bench.now, &reply) ? 1 : 0;
    while (bench.node->next_frame(&reply)) ASSERT_TRUE(is_possible(reply));
    if (i % 16 == 0) bench.advance(250'000);
    ASSERT_TRUE(std::abs(bench.torque()) <= 84.0);
  }
  EXPECT_GT(answers, 20'000);
}

TEST(Cia402Node, NeverAllocates) {
  Cia402Bench bench(with_sensors(cia402_joint(), 4.0), true);
  bench.map(canopen::kTpdoCommunication, 0x183,
            cia402::state_objects({.fd = true, .link_encoder = true}, 0), 1);
  bench.enable();
  const std::int64_t before = limber::allocations();
  CanFrame reply;
  for (int i = 0; i < 100; ++i) {
    bench.command(100);
    ASSERT_TRUE(bench.node->receive(canopen::encode_sync(), bench.joint, bench.now, &reply));
    bench.advance(Cia402Bench::kMs);
  }
  bench.wait(30);  // time-out, emergency
  bench.node->receive(canopen::encode_nmt(canopen::NmtCommand::kResetNode, 3), bench.joint,
                      bench.now, &reply);
  EXPECT_EQ(limber::allocations(), before);
}

}  // namespace
}  // namespace limber::sim::test_cia402_node
