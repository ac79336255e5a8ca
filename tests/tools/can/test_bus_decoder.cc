// Frames of every protocol, bytes worked out by hand, in words.
#include <gtest/gtest.h>

#include "tests/tools/can/arms.h"

namespace limber::test_bus_decoder {
namespace {

using bus_tools::BusDecoder;
using testing::one_motor;
using testing::said;

// --- Damiao: id 3, replies on 13, +-12.5 rad, +-30 rad/s, 500 N m/rad, 5 N m s/rad, +-10 N m
// ------

struct Damiao : ::testing::Test {
  Robot robot = one_motor("damiao_mit", 0x003, 0x013);
  BusDecoder decoder{robot, 0};
};

// 16 bits 35388 of 65535, 12 bits 1911, 491, 1228, 2559 of 4095.
TEST_F(Damiao, Command) {
  EXPECT_EQ(said(decoder, "003#8A3C7771EB4CC9FF"),
            "elbow command MIT command: position 0.99966 rad, velocity -2 rad/s, kp 59.951 "
            "N m/rad, kd 1.4994 N m s/rad, torque 2.4982 N m");
}

TEST_F(Damiao, SpecialFrames) {
  EXPECT_EQ(said(decoder, "003#FFFFFFFFFFFFFFFC"), "elbow command enable: ");
  EXPECT_EQ(said(decoder, "003#FFFFFFFFFFFFFFFD"), "elbow command disable: ");
  EXPECT_EQ(said(decoder, "003#FFFFFFFFFFFFFFFE"), "elbow command set zero: ");
  EXPECT_EQ(said(decoder, "003#FFFFFFFFFFFFFFFB"), "elbow command clear error: ");
}

// Counts 34733, 2013, 2416 and half a count more: 0.74979 + 0.00019, -0.50549 + 0.00733, 1.7998 +
// 0.0024.
TEST_F(Damiao, State) {
  EXPECT_EQ(said(decoder, "013#1387AD7DD9702926"),
            "elbow reply state: enabled, position 0.74998 rad, velocity -0.49817 rad/s, torque "
            "1.8022 N m, T_mos 41 degC, T_rotor 38 degC");
  EXPECT_EQ(said(decoder, "013#D387AD7FF7FF2926")
                .find("elbow reply state: no command within the drive's time-out, position"),
            0U);
  EXPECT_NE(said(decoder, "013#1487AD7DD9702926").find("WRONG ID 4"), std::string::npos);
}

TEST_F(Damiao, RegisterAnswersAreStatesUnlessSomebodyAsked) {
  EXPECT_EQ(said(decoder, "013#0300331700002041").substr(0, 28), "elbow reply state: disabled,");
  EXPECT_EQ(said(decoder, "7FF#0300331700000000"), "elbow command read register: TMAX");
  EXPECT_EQ(said(decoder, "013#0300331700002041"), "elbow reply register: TMAX 10 N m");
  EXPECT_EQ(said(decoder, "013#0300331700002041").substr(0, 28), "elbow reply state: disabled,");
}

TEST_F(Damiao, RegisterWrites) {
  EXPECT_EQ(said(decoder, "7FF#0300550990010000"),
            "elbow command write register: TIMEOUT 400 counts of 50 us");
  EXPECT_EQ(said(decoder, "013#0300550990010000"),
            "elbow reply register written: TIMEOUT 400 counts of 50 us");
  EXPECT_EQ(said(decoder, "7FF#0300CC0000000000"), "elbow command state request: ");
  EXPECT_EQ(said(decoder, "7FF#0300AA0100000000"), "elbow command store registers: ");
}

TEST_F(Damiao, TheOtherControlModes) {
  EXPECT_EQ(said(decoder, "103#0000003F00004040"),
            "elbow command position-velocity command: position 0.5 rad, velocity 3 rad/s");
  EXPECT_EQ(said(decoder, "203#000000C0"), "elbow command velocity command: velocity -2 rad/s");
  EXPECT_EQ(said(decoder, "303#0000003FFA00C409"),
            "elbow command force-position command: position 0.5 rad, velocity 2.5 rad/s, torque "
            "share 0.25");
  EXPECT_EQ(said(decoder, "303#FFFFFFFFFFFFFFFC"), "elbow command enable: ");
  EXPECT_EQ(said(decoder, "203#0000"), "elbow command unreadable: 00 00");
}

TEST_F(Damiao, WhatNobodyKnowsIsForeign) {
  EXPECT_EQ(said(decoder, "7FF#0400331700000000"),
            "- foreign frame: 04 00 33 17 00 00 00 00");  // to motor 4
  EXPECT_EQ(said(decoder, "123#0102"), "- foreign frame: 01 02");
  EXPECT_EQ(said(decoder, "003#0102"), "elbow command unreadable: 01 02");
}

TEST_F(Damiao, LockStepAndErrors) {
  EXPECT_EQ(said(decoder, "1FFFFFF0#0A00000000000000"), "all command TICK: cycle 10");
  EXPECT_EQ(said(decoder, "1FFFFFF1#0001000000000000"), "all reply TOCK: cycle 256");
  EXPECT_EQ(said(decoder, "20000040#0000000000000000"), "- error error frame: bus-off");
  EXPECT_EQ(said(decoder, "20000204#0020000000008007"),
            "- error error frame: controller: transmitter passive, transmit errors 128, receive "
            "errors 7");
  EXPECT_EQ(said(decoder, "20000008#0000040000000000"), "- error error frame: protocol: stuff bit");
}

TEST(Antagonist, SecondMotorHasANameOfItsOwn) {
  Robot robot = one_motor("damiao_mit", 0x003, 0x013);
  robot.joints[0].has_antagonist = true;
  robot.joints[0].antagonist = robot.joints[0].drive;
  robot.joints[0].antagonist.command_id = 0x004;
  robot.joints[0].antagonist.reply_id = 0x014;
  BusDecoder decoder(robot, 0);
  EXPECT_EQ(said(decoder, "004#FFFFFFFFFFFFFFFC"), "elbow/2 command enable: ");
}

// --- RobStride: motor 1, an RS02 -----------------------------------------------------------------

struct Robstride : ::testing::Test {
  static Robot rs02() {
    Robot robot = one_motor("robstride", 0x01000001, 0x020001FD);
    robot.joints[0].drive.range = {4.0 * std::numbers::pi, 44.0, 17.0, 500.0, 5.0};
    return robot;
  }
  Robot robot = rs02();
  BusDecoder decoder{robot, 0};
};

// 35375, 31278, 7864 and 19660 counts; torque 37586.
TEST_F(Robstride, CommandsAndRequests) {
  EXPECT_EQ(
      said(decoder, "0192D201#8A2F7A2E1EB84CCC"),
      "elbow command command: position 1.0002 rad, velocity -1.9995 rad/s, kp 59.998 N m/rad, "
      "kd 1.5 N m s/rad, torque 2.5002 N m");
  EXPECT_EQ(said(decoder, "0300FD01#0000000000000000"), "elbow command enable: ");
  EXPECT_EQ(said(decoder, "0400FD01#0000000000000000"), "elbow command stop: ");
  EXPECT_EQ(said(decoder, "0400FD01#0100000000000000"), "elbow command stop and clear faults: ");
  EXPECT_EQ(said(decoder, "1200FD01#2870000090010000"),
            "elbow command write: parameter 7028 0x00000190");
  EXPECT_EQ(said(decoder, "1100FD01#2870000000000000"), "elbow command read: parameter 7028");
}

TEST_F(Robstride, Replies) {
  EXPECT_EQ(
      said(decoder, "028001FD#87A37E8B8D8C0181"),
      "elbow reply state: running, position 0.75014 rad, velocity -0.49953 rad/s, torque 1.7998 "
      "N m, T 38.5 degC");
  EXPECT_EQ(said(decoder, "180601FD#7FFF7FFF7FFF0000")
                .find("elbow reply state, not requested: stopped, over-current, over-temperature"),
            0U);
  EXPECT_EQ(said(decoder, "110101FD#2870000000000000"), "elbow reply read refused: parameter 7028");
  EXPECT_EQ(said(decoder, "150001FD#0500000000000000"),
            "elbow reply fault: motor too hot, under-voltage");
  EXPECT_EQ(said(decoder, "028002FD#87A37E8B8D8C0181").find("elbow"), std::string::npos);
}

// --- MyActuator: motor 1, of V4.2 ----------------------------------------------------------------

struct Myactuator : ::testing::Test {
  static Robot of_v42() {
    Robot robot = one_motor("myactuator", 0x401, 0x501);
    robot.joints[0].drive.range = {12.5, 45.0, 24.0, 500.0, 5.0};
    return robot;
  }
  Robot robot = of_v42();
  BusDecoder decoder{robot, 0};
};

// 35388, 1956, 491, 1228 and 2260 counts; the manual's state, and half a count more.
TEST_F(Myactuator, Motion) {
  EXPECT_EQ(said(decoder, "401#8A3C7A41EB4CC8D4"),
            "elbow command motion: position 0.99966 rad, velocity -2.011 rad/s, kp 59.951 N m/rad, "
            "kd 1.4994 N m s/rad, torque 2.4908 N m");
  EXPECT_EQ(said(decoder, "501#01E66582EB550000"),
            "elbow reply state: position 10 rad, velocity 1.033 rad/s, torque 10.01 N m");
  EXPECT_EQ(said(decoder, "501#02E66582EB550000").substr(0, 23), "elbow reply unreadable:");
  EXPECT_EQ(said(decoder, "402#8A3C7A41EB4CC8D4").find("elbow command"), std::string::npos);
}

TEST_F(Myactuator, Orders) {
  EXPECT_EQ(said(decoder, "141#7700000000000000"), "elbow command release brake: ");
  EXPECT_EQ(said(decoder, "141#9A00000000000000"), "elbow command status: ");
  EXPECT_EQ(said(decoder, "241#9A320001E5010400"),
            "elbow reply status: under-voltage, brake released, supply 48.5 V, T 50 degC");
  EXPECT_EQ(said(decoder, "141#B3000000E8030000"), "elbow command time-out: 1000 ms");
  EXPECT_EQ(said(decoder, "141#2003000001000000"), "elbow command function: 3 1");
  EXPECT_EQ(said(decoder, "241#B20000002E893401"), "elbow reply version: 20220206");
  EXPECT_EQ(said(decoder, "241#B558385332563130"), "elbow reply model: X8S2V10");
  EXPECT_EQ(said(decoder, "241#92000000A08C0000"), "elbow reply angle: 6.2832 rad");
  EXPECT_EQ(said(decoder, "241#F100000000000000"), "elbow reply time-out is over: ");
  EXPECT_EQ(said(decoder, "141#A100000064000000"), "elbow command order A1: ");
  EXPECT_EQ(said(decoder, "141#8000").substr(0, 25), "elbow command unreadable:");
}

// --- CubeMars: motor 2, an AK80-9 ----------------------------------------------------------------

Robot ak80_9(int board) {
  Robot robot = board == 3 ? one_motor("cubemars", 0x802, 0x2902) : one_motor("cubemars", 2, 0);
  robot.joints[0].drive.board = board;
  robot.joints[0].drive.range = {12.5, 50.0, 18.0, 500.0, 5.0};
  robot.joints[0].drive.gear_ratio = 9.0;
  robot.joints[0].drive.torque_constant_Nm_per_A = 2.0;
  return robot;
}

// 30670, 2170, 204, 655 and 1569 counts; of states half a count more.
TEST(Cubemars, BoardsV1AndV2) {
  const Robot robot = ak80_9(2);
  BusDecoder decoder{robot, 0};
  EXPECT_EQ(said(decoder, "002#77CE87A0CC28F621"),
            "elbow command MIT command: position -0.80014 rad, velocity 2.9915 rad/s, kp 24.908 N "
            "m/rad, kd 0.79976 N m s/rad, torque -4.2066 N m");
  EXPECT_EQ(said(decoder, "002#FFFFFFFFFFFFFFFC"), "elbow command enable: ");
  EXPECT_EQ(said(decoder, "002#FFFFFFFFFFFFFFFE"), "elbow command set zero: ");
  EXPECT_EQ(said(decoder, "000#0277CE87A6212402"),
            "elbow reply state: over-current, position -0.79995 rad, velocity 3.0037 rad/s, torque "
            "-4.2022 N m, T 36 degC");
  EXPECT_EQ(said(decoder, "000#0377CE87A6212402").find("elbow"), std::string::npos);
  EXPECT_EQ(said(decoder, "000#0277CE87A621").substr(0, 23), "elbow reply unreadable:");
  EXPECT_EQ(said(decoder, "00002902#0000000000001E00"),
            "elbow reply state of servo mode: it hears no MIT frame: ");
  const Robot v1 = ak80_9(1);
  BusDecoder of_v1{v1, 0};
  EXPECT_EQ(said(of_v1, "000#0277CE87A621"),
            "elbow reply state: position -0.79995 rad, velocity 3.0037 rad/s, torque -4.2022 N m");
}

TEST(Cubemars, BoardsV3) {
  const Robot robot = ak80_9(3);
  BusDecoder decoder{robot, 0};
  EXPECT_EQ(said(decoder, "00000802#0CC28F77CE87A621").substr(0, 48),
            "elbow command MIT command: position -0.80014 rad");
  EXPECT_EQ(said(decoder, "00000102#00000000").substr(0, 23), "elbow command packet 1:");
  EXPECT_EQ(said(decoder, "00002902#0384FF9C00961F07"),
            "elbow reply state: stalled, position 1.5708 rad, velocity -0.55407 rad/s, torque 3 N "
            "m, T 31 degC");
}

// --- ODrive: node 2 ------------------------------------------------------------------------------

TEST(Odrive, ItsMessages) {
  const Robot robot = one_motor("odrive", 0x4E, 0x49);
  BusDecoder decoder{robot, 0};
  EXPECT_EQ(said(decoder, "04E#CDCC4CBE"), "elbow command torque: torque -0.2 N m");
  EXPECT_EQ(said(decoder, "04B#0100000001000000"),
            "elbow command set mode: control_mode 1, input_mode 1");
  EXPECT_EQ(said(decoder, "047#08000000"), "elbow command set state: state closed loop");
  EXPECT_EQ(said(decoder, "049#87F9A23E0000C0BF"),
            "elbow reply estimates: position 0.31831 turn, velocity -1.5 turn/s");
  EXPECT_EQ(said(decoder, "05C#CDCC4CBE000040BE"),
            "elbow reply torques: target -0.2 N m, estimate -0.1875 N m");
  EXPECT_EQ(said(decoder, "041#0000000101030000"),
            "elbow reply heartbeat: error watchdog expired, state idle, result 3, done 0");
  EXPECT_EQ(said(decoder, "043#0000000000040000"),
            "elbow reply error: active_errors 0, disarm_reason over-current");
  EXPECT_EQ(said(decoder, "044#01F30000"), "elbow command endpoint request: write 1, endpoint 243");
  EXPECT_EQ(said(decoder, "05C#"), "elbow command torques asked for: ");
  EXPECT_EQ(said(decoder, "04C#0000000000000000").substr(0, 25), "elbow command message 0C:");
  EXPECT_EQ(said(decoder, "058#"), "elbow command clear errors: ");
  EXPECT_EQ(said(decoder, "069#87F9A23E0000C0BF").find("elbow"), std::string::npos);
}

// --- moteus: servo 4 -----------------------------------------------------------------------------

struct Moteus : ::testing::Test {
  Robot robot = one_motor("moteus", 0x8004, 0x400);
  BusDecoder decoder{robot, 0};
};

TEST_F(Moteus, CommandInFloats) {
  EXPECT_EQ(said(decoder,
                 "00008004##1 01000A 0C0520CDCCCC3D000000009A99593FCDCC4C3ECDCCCC3D 0D270AD7A33C "
                 "1100 1F01 130D 50505050505050505050"),
            "elbow command write: mode position, position 0.1 turns, velocity 0 turns/s, "
            "feed-forward torque 0.85 N m, kp scale 0.2, kd scale 0.1, watchdog 0.02 s, asks for "
            "mode, position, velocity, torque, voltage, board temperature, fault");
}

TEST_F(Moteus, CommandInCounts) {
  EXPECT_EQ(said(decoder,
                 "00008004##1 01000A 040620 0080 0000 5500 0000 0000 C800 50"
                 "140400 130D"),
            "elbow command write: mode position, position nan turns, velocity 0 turns/s, "
            "feed-forward torque 0.85 N m, kp scale 0, kd scale 0, maximum torque 2 N m, asks for "
            "mode, position, velocity, torque, voltage, board temperature, fault");
}

TEST_F(Moteus, Replies) {
  EXPECT_EQ(said(decoder, "400##1 240400 0A00 E803 9CFF 5500 230D 60 1E 00"),
            "elbow reply registers: mode position, position 0.1 turns, velocity -0.025 turns/s, "
            "torque 0.85 N m, voltage 48 V, board temperature 30 degC, fault none");
  EXPECT_EQ(said(decoder, "400##1 210001 210F25"),
            "elbow reply registers: mode fault, fault PWM cycle overrun");
  EXPECT_EQ(said(decoder, "400##1 311C01 50"),
            "elbow reply refused: register 01Ch no such register");
}

TEST_F(Moteus, OtherTrafficIsShownRaw) {
  EXPECT_EQ(said(decoder, "00008004##1 42013D"), "elbow command text poll: ");
  EXPECT_EQ(said(decoder,
                 "004##1400109"
                 "74656C2073746F700A"),
            "elbow command text: \"tel stop\\n\"");
  EXPECT_EQ(said(decoder, "400##14101054F4B0D0A00"), "elbow reply text: \"OK\\n\\x00\"");
  EXPECT_EQ(said(decoder, "00008004##144010001"), "elbow command no registers: 44 01 00 01");
  EXPECT_EQ(said(decoder, "500##1 210001"), "- foreign frame: 21 00 01");  // from servo 5
}

// --- CANopen: node 3, 16384 counts a turn, rated torque 28 N m
// ------------------------------------

struct Canopen : ::testing::Test {
  Robot robot = one_motor("cia402", 0x203, 0x183);
  BusDecoder decoder{robot, 0};

  /// The master maps TPDO1 anew: status, position, torque.
  void map_state() {
    for (const char* write :
         {"2300180183010080", "2F001A0000000000", "23001A0110004160", "23001A0220006460",
          "23001A0310007760", "2F001A0003000000", "2F00180201000000", "2300180183010000"}) {
      said(decoder, std::string("603#") + write);
      said(decoder, "583#60" + std::string(write).substr(2, 6) + "00000000");
    }
  }
};

TEST_F(Canopen, NetworkManagement) {
  EXPECT_EQ(said(decoder, "000#0103"), "elbow command NMT: start");
  EXPECT_EQ(said(decoder, "000#8000"), "all command NMT: enter pre-operational");
  EXPECT_EQ(said(decoder, "000#8105"), "node 5 command NMT: reset node");
  EXPECT_EQ(said(decoder, "703#00"), "elbow reply heartbeat: boot-up");
  EXPECT_EQ(said(decoder, "703#05"), "elbow reply heartbeat: operational");
  EXPECT_EQ(said(decoder, "080#"), "all command SYNC: ");
  EXPECT_EQ(said(decoder, "080#07"), "all command SYNC: counter 7");
}

TEST_F(Canopen, ServiceData) {
  EXPECT_EQ(said(decoder, "603#2F6060000A000000"), "elbow command SDO write: 6060h:00 mode 10");
  EXPECT_EQ(said(decoder, "583#6060600000000000"), "elbow reply SDO written: 6060h:00 mode");
  EXPECT_EQ(said(decoder, "603#4076600000000000"), "elbow command SDO read: 6076h:00 rated torque");
  EXPECT_EQ(said(decoder, "583#43766000606D0000"),
            "elbow reply SDO value: 6076h:00 rated torque 28000 mN m");
  EXPECT_EQ(said(decoder, "583#8041600002000106"),
            "elbow reply SDO abort: 6041h:00 06010002h object is read only");
  EXPECT_EQ(said(decoder, "603#2B40600006000000"),
            "elbow command SDO write: 6040h:00 controlword 0006h (shutdown)");
  EXPECT_EQ(said(decoder, "603#4002210100000000"),
            "elbow command SDO read: 2102h:01 object 2102h:01");
  EXPECT_EQ(said(decoder, "603#2300140100000080").substr(0, 43),
            "elbow command SDO write: 1400h:01 RPDO1 COB");
}

TEST_F(Canopen, CommandAsTheStartUpMapsIt) {
  EXPECT_EQ(said(decoder, "203#0F00C800"),
            "elbow command RPDO1: controlword 000Fh (enable operation), target torque 5.6 N m");
  EXPECT_EQ(said(decoder, "203#0F00"),
            "elbow command RPDO1: controlword 000Fh (enable operation), TOO SHORT 0F 00");
}

// 81920 counts are five turns, 31.416 rad; -15 thousandths of 28 N m are -0.42 N m.
TEST_F(Canopen, StateAsTheMasterMapsIt) {
  map_state();
  EXPECT_EQ(said(decoder, "183#371600400100F1FF"),
            "elbow reply TPDO1: statusword 1637h (operation enabled), position 31.416 rad, torque "
            "-0.42 N m");
}

TEST_F(Canopen, AMappingThatTheNodeRefusesChangesNothing) {
  map_state();
  said(decoder, "603#23001A0310007860");
  said(decoder, "583#80001A0341000406");
  EXPECT_NE(said(decoder, "183#371600400100F1FF").find("torque -0.42"), std::string::npos);
  said(decoder, "603#2300180183010080");
  said(decoder, "583#6000180100000000");
  EXPECT_EQ(said(decoder, "183#371600400100F1FF").substr(0, 15), "- foreign frame");
}

TEST_F(Canopen, Emergencies) {
  EXPECT_EQ(said(decoder, "083#3081110000000000"),
            "elbow reply EMCY: 8130h heartbeat lost, error register 11h, vendor 00 00 00 00 00");
  EXPECT_EQ(said(decoder, "083#0000000000000000"),
            "elbow reply EMCY: 0000h all errors are gone, error register 00h, vendor 00 00 00 00 "
            "00");
  EXPECT_EQ(said(decoder, "083#1043080000000000").substr(0, 37),
            "elbow reply EMCY: 4310h drive too hot");
}

// --- tip sensors ---------------------------------------------------------------------------------

Robot with_tip_sensor(TipSensorProtocol protocol) {
  Robot robot = one_motor("damiao_mit", 0x003, 0x013);
  robot.has_tip_sensor = true;
  robot.tip_sensor.protocol = protocol;
  robot.tip_sensor.command_id = 0x64;
  robot.tip_sensor.reply_ids = {1, 2};
  return robot;
}

// 50 counts a newton, 2000 a newton metre: 500, -100, 0, then 2000 astride the frames, 0, -1.
TEST(TipSensor, TwoFramesOfARobotousSensor) {
  const Robot robot = with_tip_sensor(TipSensorProtocol::kRobotousRft);
  BusDecoder decoder(robot, 0);
  EXPECT_EQ(said(decoder, "064#0A00000000000000"), "tip command request: ");
  EXPECT_EQ(said(decoder, "001#0A01F4FF9C000007"), "tip reply first half: ");
  EXPECT_EQ(said(decoder, "002#D00000FFFF200000"),
            "tip reply wrench: Fx 10 N, Fy -2 N, Fz 0 N, Tx 1 N m, Ty 0 N m, Tz -0.0005 N m, "
            "OVERLOAD Fx");
  EXPECT_EQ(said(decoder, "002#D00000FFFF200000").substr(0, 28), "tip reply second half alone:");
}

TEST(TipSensor, OneFrameOfFloats) {
  const Robot robot = with_tip_sensor(TipSensorProtocol::kLimberFt);
  BusDecoder decoder(robot, 0);
  EXPECT_EQ(said(decoder, "064##10A07"), "tip command request: counter 7");
  EXPECT_EQ(said(decoder,
                 "001##1 0A070000 00002041 000000C0 00000000 0000803F 00000000 00000000 "
                 "00000000"),
            "tip reply wrench: Fx 10 N, Fy -2 N, Fz 0 N, Tx 1 N m, Ty 0 N m, Tz 0 N m, counter 7");
}

}  // namespace
}  // namespace limber::test_bus_decoder
