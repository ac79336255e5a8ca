// CANopen services of the emulated drive, node 3, byte by byte where bytes matter.
#include <gtest/gtest.h>

#include <string>

#include "sim/nodes/canopen_pdos.h"
#include "tests/sim/cia402_bench.h"

namespace limber::sim::test_canopen_node {
namespace {

using canopen::Object;
using canopen::pdo_cob_id;
using canopen::pdo_mapped;
using canopen::pdo_mapped_count;
using canopen::pdo_type;
using canopen::SdoAbort;
using limber::testing::cia402_joint;
using limber::testing::Cia402Bench;
using limber::testing::with_sensors;

constexpr std::int64_t kMs = Cia402Bench::kMs;
constexpr std::uint16_t kTpdo = canopen::kTpdoCommunication;
constexpr std::uint16_t kRpdo = canopen::kRpdoCommunication;
constexpr std::uint16_t kTpdoMap = canopen::kTpdoMapping;
constexpr std::uint16_t kRpdoMap = canopen::kRpdoMapping;

constexpr std::uint32_t code(SdoAbort abort) { return static_cast<std::uint32_t>(abort); }

// --- network management ---

TEST(CanopenNode, BootsUpOnceAndAgainAfterAReset) {
  Cia402Node node(cia402_joint(), false);
  CanFrame frame;
  ASSERT_TRUE(node.next_frame(&frame));
  EXPECT_EQ(limber::testing::text(frame), "703#00");
  EXPECT_FALSE(node.next_frame(&frame));

  Cia402Bench bench;
  bench.write(canopen::kHeartbeatPeriod_ms, 100);
  bench.write(cia402::kQuickStopOption, 6);
  bench.send("000#8203");  // communication only
  EXPECT_EQ(bench.heard(), "703#00");
  EXPECT_EQ(bench.read(canopen::kHeartbeatPeriod_ms), 0U);
  EXPECT_EQ(bench.read(cia402::kQuickStopOption), 6U);
  bench.send("000#8100");
  EXPECT_EQ(bench.heard(), "703#00");
  EXPECT_EQ(bench.read(cia402::kQuickStopOption), 2U);
}

TEST(CanopenNode, HeartbeatsTellTheState) {
  Cia402Bench bench;
  EXPECT_EQ(bench.write(canopen::kHeartbeatPeriod_ms, 10), "583#6017100000000000");
  bench.wait(9);
  EXPECT_EQ(bench.heard(), "");
  bench.wait(1);
  EXPECT_EQ(bench.heard(), "703#7F");
  bench.send("000#0103");
  bench.wait(10);
  EXPECT_EQ(bench.heard(), "703#05");
  bench.send("000#0200");
  bench.wait(20);
  EXPECT_EQ(bench.heard(), "703#04 703#04");
}

TEST(CanopenNode, EachStateHasItsServices) {
  Cia402Bench bench;
  bench.map(kTpdo, 0x183, std::span(&cia402::kStatusword, 1), 1);
  EXPECT_EQ(bench.send("080#"), "none");  // pre-operational: no PDO
  bench.send("000#0104");                 // for somebody else
  EXPECT_EQ(bench.send("080#"), "none");
  bench.send("000#0103");
  EXPECT_EQ(bench.send("080#"), "183#5002");
  EXPECT_EQ(bench.send("603#4041600000000000"), "583#4B41600050020000");
  bench.send("000#0203");  // stopped: neither
  EXPECT_EQ(bench.send("080#"), "none");
  EXPECT_EQ(bench.send("603#4041600000000000"), "none");
  bench.send("000#8000");
  EXPECT_EQ(bench.send("603#4041600000000000"), "583#4B41600050020000");
}

TEST(CanopenNode, LostHeartbeatOfTheMaster) {
  Cia402Bench bench;
  bench.write(canopen::kConsumerHeartbeat, 0x007F0032);  // node 127, 50 ms
  bench.send("000#0103");
  bench.wait(200);
  EXPECT_EQ(bench.heard(), "");  // not yet heard, not yet missed
  bench.send("77F#05");
  bench.wait(50);
  EXPECT_EQ(bench.heard(), "");
  bench.wait(1);
  EXPECT_EQ(bench.heard(), "083#3081110000000000");
  EXPECT_EQ(bench.read(canopen::ObjectId{0x1001, 0}), 0x11U);
  EXPECT_EQ(bench.read(canopen::ObjectId{0x1003, 1}), 0x8130U);
  bench.send("77F#05");
  EXPECT_EQ(bench.heard(), "083#0000000000000000");
  EXPECT_EQ(bench.read(canopen::ObjectId{0x1001, 0}), 0U);
  EXPECT_EQ(bench.read(canopen::ObjectId{0x1003, 0}),
            1U);  // the history stays until a 0 is written
  EXPECT_EQ(bench.refusal({{0x1003, 0}, 1}, 1), code(SdoAbort::kTooHigh));
  EXPECT_EQ(bench.refusal({{0x1003, 0}, 1}, 0), 0U);
  EXPECT_EQ(bench.read(canopen::ObjectId{0x1003, 1}), 0U);
}

TEST(CanopenNode, ErrorBehaviourSaysWhereALostHeartbeatLeads) {
  for (const auto& [behaviour, state] :
       {std::pair{0U, "703#7F"}, std::pair{1U, "703#05"}, std::pair{2U, "703#04"}}) {
    Cia402Bench bench;
    bench.write(canopen::kErrorBehaviour, behaviour);
    bench.write(canopen::kConsumerHeartbeat, 0x007F0032);
    bench.send("000#0103");
    bench.send("77F#05");
    bench.wait(51);
    EXPECT_EQ(bench.heard(), "083#3081110000000000");
    bench.write(canopen::kHeartbeatPeriod_ms, 10);
    if (behaviour == 2) continue;  // stopped: no SDO to ask for a heartbeat
    bench.wait(10);
    EXPECT_EQ(bench.heard(), state);
  }
}

// --- SDO ---

TEST(CanopenNode, WorkedSdoFrames) {
  Cia402Bench bench;
  EXPECT_EQ(bench.send("603#2F6060000A000000"), "583#6060600000000000");
  EXPECT_EQ(bench.send("603#4076600000000000"), "583#43766000606D0000");
  EXPECT_EQ(bench.send("603#2B41600001000000"), "583#8041600002000106");
  EXPECT_EQ(bench.send("604#4076600000000000"), "none");
  EXPECT_EQ(bench.send("603#40766000000000"), "none");
}

TEST(CanopenNode, AbortCodes) {
  Cia402Bench bench;
  EXPECT_EQ(bench.send("603#4000300000000000"), "583#8000300000000206");  // no such object
  EXPECT_EQ(bench.send("603#4076600100000000"), "583#8076600111000906");  // no such subindex
  EXPECT_EQ(bench.send("603#2F40600006000000"), "583#8040600010000706");  // length
  EXPECT_EQ(bench.send("603#2240600006000000"), "583#6040600000000000");  // length not said
  EXPECT_EQ(bench.send("603#2F60600003000000"), "583#8060600030000906");  // profile velocity
  EXPECT_EQ(bench.send("603#2B5A600009000000"), "583#805A600031000906");  // 605Ah up to 8
  EXPECT_EQ(bench.send("603#2B5A6000FFFF0000"), "583#805A600032000906");  // and not below 0
  EXPECT_EQ(bench.send("603#A040600000000000"), "583#8040600001000405");  // block upload
  EXPECT_EQ(bench.send("603#6000000000000000").substr(12), "01000405");   // no transfer under way
  EXPECT_EQ(bench.send("603#8041600002000106"), "none");                  // the client's own abort
}

TEST(CanopenNode, TextsAreReadInSegments) {
  Cia402Bench bench;
  // "limber bench motor" is 18 characters: 7 + 7 + 4.
  EXPECT_EQ(bench.send("603#4008100000000000"), "583#4108100012000000");
  EXPECT_EQ(bench.send("603#6000000000000000"), "583#006C696D62657220");
  EXPECT_EQ(bench.send("603#7000000000000000"), "583#1062656E6368206D");
  EXPECT_EQ(bench.send("603#6000000000000000"), "583#076F746F72000000");
  EXPECT_EQ(bench.send("603#7000000000000000").substr(12), "01000405");  // it is over
}

TEST(CanopenNode, WrittenInSegments) {
  Cia402Bench bench;
  EXPECT_EQ(bench.send("603#2103640009000000"), "583#6003640000000000");
  EXPECT_EQ(bench.send("603#0061626364656667"), "583#2000000000000000");
  EXPECT_EQ(bench.send("603#1B68690000000000"), "583#3000000000000000");
  EXPECT_EQ(bench.send("603#4003640000000000"), "583#4103640009000000");
  EXPECT_EQ(bench.send("603#6000000000000000"), "583#0061626364656667");
  EXPECT_EQ(bench.send("603#7000000000000000"), "583#1B68690000000000");
  // Numbers, too, may come so.
  EXPECT_EQ(bench.send("603#215A600002000000"), "583#605A600000000000");
  EXPECT_EQ(bench.send("603#0B06000000000000"), "583#2000000000000000");
  EXPECT_EQ(bench.read(cia402::kQuickStopOption), 6U);
}

TEST(CanopenNode, SegmentsOutOfStepEndTheTransfer) {
  Cia402Bench bench;
  bench.send("603#4008100000000000");
  EXPECT_EQ(bench.send("603#7000000000000000"), "583#8008100000000305");
  EXPECT_EQ(bench.send("603#6000000000000000").substr(12), "01000405");

  bench.send("603#2103640009000000");
  bench.send("603#0061626364656667");
  EXPECT_EQ(bench.send("603#0B68690000000000"), "583#8003640000000305");
  EXPECT_EQ(bench.send("603#4003640000000000"), "583#410364000B000000");  // "bench motor" still

  bench.send("603#2103640009000000");
  bench.send("603#0061626364656667");
  EXPECT_EQ(bench.send("603#1968696A00000000"), "583#8003640010000706");  // ten, not nine
  EXPECT_EQ(bench.send("603#2103640021000000"), "583#8003640010000706");  // 33 do not fit
  EXPECT_EQ(bench.send("603#2108100001000000"), "583#8008100002000106");
}

TEST(CanopenNode, GivesUpOnAClientThatLeaves) {
  Cia402Bench bench;
  bench.send("603#4008100000000000");
  bench.wait(1000);
  EXPECT_EQ(bench.heard(), "");
  bench.wait(1);
  EXPECT_EQ(bench.heard(), "583#8008100000000405");
  bench.wait(1001);
  EXPECT_EQ(bench.heard(), "");
}

// --- PDO configuration ---

TEST(CanopenNode, WorkedMappingOfAPdo) {
  Cia402Bench bench;
  bench.joint.theta = 5.0 * 6.283185307179586 + 1e-9;  // 81920 counts of 2^14
  bench.joint.current_A = -0.21;                       // 2 N m/A: -0.42 N m
  const std::pair<const char*, const char*> frames[] = {
      {"603#2300180183010080", "583#6000180100000000"},
      {"603#2F001A0000000000", "583#60001A0000000000"},
      {"603#23001A0110004160", "583#60001A0100000000"},
      {"603#23001A0220006460", "583#60001A0200000000"},
      {"603#23001A0310007760", "583#60001A0300000000"},
      {"603#2F001A0003000000", "583#60001A0000000000"},
      {"603#2F00180201000000", "583#6000180200000000"},
      {"603#2300180183010000", "583#6000180100000000"},
  };
  for (const auto& [request, answer] : frames) EXPECT_EQ(bench.send(request), answer);
  bench.enable();
  EXPECT_EQ(bench.send("080#"), "183#371600400100F1FF");
}

TEST(CanopenNode, ObjectsThatCannotBeMapped) {
  Cia402Bench bench;
  const auto refusal = [&](std::uint16_t mapping, std::uint32_t entry) {
    return bench.refusal(pdo_mapped(mapping, 1), entry);
  };
  EXPECT_EQ(refusal(kTpdoMap, 0x60E40120), code(SdoAbort::kNoSuchObject));  // no link encoder
  EXPECT_EQ(refusal(kTpdoMap, 0x60410110), code(SdoAbort::kNoSuchSub));
  EXPECT_EQ(refusal(kTpdoMap, 0x60410020), code(SdoAbort::kNotMappable));  // it has 16 bits
  EXPECT_EQ(refusal(kTpdoMap, 0x605A0010), code(SdoAbort::kNotMappable));
  EXPECT_EQ(refusal(kTpdoMap, 0x10080000), code(SdoAbort::kNotMappable));
  EXPECT_EQ(refusal(kTpdoMap, 0x00060010), code(SdoAbort::kNotMappable));  // dummies: RPDO only
  EXPECT_EQ(refusal(kRpdoMap, 0x00060010), 0U);
  EXPECT_EQ(refusal(kRpdoMap, 0x00060020), code(SdoAbort::kNotMappable));
  EXPECT_EQ(refusal(kRpdoMap, 0x60410010), code(SdoAbort::kNotMappable));  // read only
  Cia402Bench sensing(with_sensors(cia402_joint()));
  EXPECT_EQ(sensing.refusal(pdo_mapped(kTpdoMap, 1), 0x60E40120), 0U);
  EXPECT_EQ(bench.read(cia402::kLinkPosition), code(SdoAbort::kNoSuchObject));
}

TEST(CanopenNode, APdoHoldsWhatTheBusCanCarry) {
  for (const bool fd : {false, true}) {
    Cia402Bench bench(with_sensors(cia402_joint()), fd);
    for (int i = 1; i <= 16; ++i) bench.write(pdo_mapped(kTpdoMap, i), cia402::kPosition.mapping());
    const std::uint32_t most = fd ? 16 : 2;
    EXPECT_EQ(bench.refusal(pdo_mapped_count(kTpdoMap), most), 0U);
    EXPECT_EQ(bench.refusal(pdo_mapped_count(kTpdoMap), most + 1),
              code(fd ? SdoAbort::kTooHigh : SdoAbort::kPdoTooLong));
  }
  Cia402Bench bench;
  EXPECT_EQ(bench.refusal(pdo_mapped_count(kTpdoMap), 1), code(SdoAbort::kNotMappable));  // empty
}

TEST(CanopenNode, PdosChangeOnlyWhenTheyMay) {
  Cia402Bench bench;
  const std::uint32_t wrong = code(SdoAbort::kWrongState);
  bench.map(kTpdo, 0x183, std::span(&cia402::kStatusword, 1), 1);
  EXPECT_EQ(bench.refusal(pdo_mapped_count(kTpdoMap), 0), wrong);  // enabled
  EXPECT_EQ(bench.refusal(pdo_cob_id(kTpdo), 0x184), wrong);
  bench.write(pdo_cob_id(kTpdo), 0x80000183);
  EXPECT_EQ(bench.refusal(pdo_mapped(kTpdoMap, 1), 0x60640020), wrong);  // still counted
  EXPECT_EQ(bench.refusal(pdo_type(kTpdo), 241), code(SdoAbort::kValueRange));
  EXPECT_EQ(bench.refusal(pdo_cob_id(kTpdo), 0x603), code(SdoAbort::kValueRange));
  EXPECT_EQ(bench.refusal(pdo_cob_id(kTpdo), 0x20000183), code(SdoAbort::kValueRange));
  bench.send("000#0103");
  EXPECT_EQ(bench.refusal(pdo_cob_id(kTpdo), 0x183), wrong);
  EXPECT_EQ(bench.refusal(pdo_type(kTpdo), 1), wrong);
  EXPECT_EQ(bench.refusal(canopen::pdo_event_timer_ms(kRpdo), 20), 0U);
}

// --- PDOs at work ---

TEST(CanopenNode, SynchronousRpdosWaitForTheSync) {
  Cia402Bench bench;
  bench.enable();
  bench.command(200);
  EXPECT_EQ(bench.torque(), 0.0);
  bench.command(100);  // the latest counts
  bench.send("080#");
  EXPECT_DOUBLE_EQ(bench.torque(), 2.8);
  bench.send("080#");
  EXPECT_DOUBLE_EQ(bench.torque(), 2.8);
}

TEST(CanopenNode, OtherRpdosActAtOnce) {
  for (const std::uint8_t type : {254, 255}) {
    Cia402Bench bench;
    bench.write(cia402::kMode, 10);
    bench.map(kRpdo, 0x203, cia402::command_objects(), type);
    bench.send("000#0103");
    bench.wait(2);
    for (const char* word : {"203#06000000", "203#07000000", "203#0F00C800"}) bench.send(word);
    EXPECT_DOUBLE_EQ(bench.torque(), 5.6);
  }
}

TEST(CanopenNode, FourNodesShareAnRpdoByDummies) {
  Cia402Bench bench;
  bench.write(cia402::kMode, 10);
  // This node's command is behind that of another.
  const Object mapped[] = {
      {{0x0006, 0}, 2}, {{0x0003, 0}, 2}, cia402::kControlword, cia402::kTargetTorque};
  bench.map(kRpdo, 0x201, mapped, 255);
  bench.send("000#0103");
  bench.wait(2);
  for (const char* word :
       {"201#0600000006000000", "201#0700000007000000", "201#060011110F009CFF"}) {
    bench.send(word);
  }
  EXPECT_DOUBLE_EQ(bench.torque(), -2.8);
}

TEST(CanopenNode, ShortRpdosAreNoCommandsLongOnesAre) {
  Cia402Bench bench;
  bench.enable();
  bench.command(100);
  bench.send("080#");
  bench.send("203#0F00C8");
  EXPECT_EQ(bench.heard(), "083#1082110000000000");
  bench.send("203#0F00C8");
  EXPECT_EQ(bench.heard(), "");  // told once
  bench.send("080#");
  EXPECT_DOUBLE_EQ(bench.torque(), 2.8);
  bench.send("203#0F00C800FFFF");
  EXPECT_EQ(bench.heard(), "083#0000000000000000");
  bench.send("080#");
  EXPECT_DOUBLE_EQ(bench.torque(), 5.6);
}

TEST(CanopenNode, TpdosAtEverySyncAndEveryThird) {
  Cia402Bench bench;
  bench.map(kTpdo, 0x183, std::span(&cia402::kStatusword, 1), 1);
  bench.map(kTpdo + 1, 0x283, std::span(&cia402::kModeInForce, 1), 3);
  bench.send("000#0103");
  for (int round = 0; round < 3; ++round) {
    for (int i = 1; i <= 3; ++i) {
      EXPECT_EQ(bench.send("080#"), "183#5002");
      EXPECT_EQ(bench.heard(), i == 3 ? "283#00" : "");
    }
  }
}

TEST(CanopenNode, TpdosOnChange) {
  Cia402Bench bench;
  bench.map(kTpdo, 0x183, std::span(&cia402::kModeInForce, 1), 0);  // at SYNC, if changed
  bench.map(kTpdo + 1, 0x283, std::span(&cia402::kModeInForce, 1), 255);
  bench.map(kTpdo + 2, 0x383, std::span(&cia402::kStatusword, 1), 255);
  bench.write(canopen::pdo_event_timer_ms(kTpdo + 2), 5);
  bench.send("000#0103");
  bench.wait(1);
  EXPECT_EQ(bench.heard(), "283#00 383#5002");
  EXPECT_EQ(bench.send("080#"), "183#00");
  EXPECT_EQ(bench.send("080#"), "none");
  bench.write(cia402::kMode, 10);
  bench.wait(2);
  EXPECT_EQ(bench.heard(), "283#0A");
  EXPECT_EQ(bench.send("080#"), "183#0A");
  bench.wait(3);
  EXPECT_EQ(bench.heard(), "383#5002");  // its event timer
}

TEST(CanopenNode, InhibitTimeKeepsEventsApart) {
  Cia402Bench bench;
  bench.map(kTpdo, 0x183, std::span(&cia402::kPosition, 1), 255);
  bench.write(canopen::pdo_inhibit_time(kTpdo), 50);  // 5 ms
  bench.send("000#0103");
  int frames = 0;
  for (int ms = 1; ms <= 20; ++ms) {
    bench.joint.theta = 0.1 * ms;
    bench.wait(1);
    frames += bench.heard().empty() ? 0 : 1;
  }
  EXPECT_EQ(frames, 4);  // at 1, 6, 11, 16 ms
}

TEST(CanopenNode, SyncWithACounter) {
  Cia402Bench bench;
  bench.map(kTpdo, 0x183, std::span(&cia402::kStatusword, 1), 1);
  bench.send("000#0103");
  EXPECT_EQ(bench.send("080#07"), "none");
  EXPECT_EQ(bench.heard(), "083#4082110000000000");
  EXPECT_EQ(bench.send("080#"), "183#5002");
  EXPECT_EQ(bench.heard(), "083#0000000000000000");
  bench.write(canopen::kSyncCounterOverflow, 10);
  EXPECT_EQ(bench.send("080#07"), "183#5002");
  EXPECT_EQ(bench.send("080#"), "none");
}

TEST(CanopenNode, FdFramesArePadded) {
  Cia402Bench bench(with_sensors(cia402_joint()), true);
  bench.map(kTpdo, 0x183, cia402::state_objects({.fd = true, .link_encoder = true}, 0), 1);
  bench.send("000#0103");
  CanFrame reply;
  ASSERT_TRUE(bench.node->receive(canopen::encode_sync(), bench.joint, bench.now, &reply));
  EXPECT_EQ(reply.length, 24);
  EXPECT_TRUE(reply.fd && reply.bitrate_switch);
}

TEST(CanopenNode, WhatFitsAClassicFrameIsOneOnAnFdBusToo) {
  Cia402Bench bench(with_sensors(cia402_joint()), true);
  const cia402::StateLayout layout = {.torque_sensor = true};
  bench.map(kTpdo, 0x183, cia402::state_objects(layout, 0), 1);
  bench.map(kTpdo + 1, 0x283, cia402::state_objects(layout, 1), 1);
  bench.send("000#0103");
  CanFrame reply;
  ASSERT_TRUE(bench.node->receive(canopen::encode_sync(), bench.joint, bench.now, &reply));
  EXPECT_EQ(limber::testing::text(reply), "183#500200000000");
  EXPECT_FALSE(reply.fd);
  ASSERT_TRUE(bench.node->next_frame(&reply));
  EXPECT_EQ(limber::testing::text(reply), "283#0000000000000000");
  EXPECT_FALSE(reply.fd);
}

}  // namespace
}  // namespace limber::sim::test_canopen_node
