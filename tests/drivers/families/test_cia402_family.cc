// A CiA 402 drive's family by itself: torques in thousandths, states in words, every answer to
// every step of its start-up.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <string>

#include "drivers/families/drive_family.h"
#include "tests/drivers/families/fake_cia402.h"

namespace limber::test_cia402_family {
namespace {

using testing::cia402_robot;
using testing::parse;
using testing::text;

constexpr double kPeriod_s = 1e-3;
constexpr std::uint32_t kNoSuchObject = 0x06020000;
constexpr std::uint32_t kNoSuchSub = 0x06090011;
constexpr std::uint32_t kReadOnly = 0x06010002;

DriveFamily family_of(const JointConfig& joint, bool fd = true, double period_s = kPeriod_s) {
  return make_drive_family(joint, fd, period_s);
}

/// Node 3 without sensors; node 4 has all.
class Cia402FamilyTest : public ::testing::Test {
 protected:
  static JointConfig plain(bool fd = true) { return cia402_robot(fd).joints[0]; }
  static JointConfig elastic() { return cia402_robot().joints[1]; }

  double sent(double torque_Nm) {
    CanFrame frame;
    DriveCommand sent;
    EXPECT_TRUE(family_.codec->command({.torque_Nm = torque_Nm}, {}, &frame, &sent));
    return sent.torque_Nm;
  }
  /// The step that reads an object, or, `writing`, the first that writes it; -1: none.
  int step(std::uint32_t reg, bool writing = false) const {
    for (int i = 0; i < family_.startup->steps(); ++i) {
      const bool writes = family_.startup->request(i).data[0] != 0x40;
      if (family_.startup->step(i).reg == reg && writes == writing) return i;
    }
    return -1;
  }
  /// What the drive answers to step `index`: a value, or that it was written.
  CanFrame reply(int index, std::uint32_t raw) const {
    CanFrame frame = family_.startup->request(index);
    frame.id -= 0x80;
    const bool writes = frame.data[0] != 0x40;
    frame.data[0] = writes ? 0x60 : 0x43;
    for (unsigned i = 0; i < 4; ++i)
      frame.data[4 + i] = writes ? 0 : static_cast<std::uint8_t>(raw >> 8 * i);
    return frame;
  }
  CanFrame abort(int index, std::uint32_t code) const {
    CanFrame frame = reply(index, 0);
    frame.data[0] = 0x80;
    for (unsigned i = 0; i < 4; ++i) frame.data[4 + i] = static_cast<std::uint8_t>(code >> 8 * i);
    return frame;
  }
  Answer check(int index, const CanFrame& frame) {
    found_ = -77.0;
    return family_.startup->check_answer(index, frame, &found_);
  }
  Answer answered(std::uint32_t reg, std::uint32_t raw) {
    return check(step(reg), reply(step(reg), raw));
  }
  double expected(std::uint32_t reg) const { return family_.startup->step(step(reg)).expected; }

  DriveFamily family_ = family_of(plain());
  double found_ = 0.0;
};

// --- torque and state ---------------------------------------------------------------------------

TEST_F(Cia402FamilyTest, NoTorqueBeyondTheLimitAndAllUpToIt) {
  EXPECT_NEAR(sent(100.0), 14.0, 1e-12) << "500 thousandths of 28 N m";
  EXPECT_NEAR(sent(-100.0), -14.0, 1e-12);
  JointConfig strong = plain();
  strong.torque_limit_Nm = strong.drive.range.torque_Nm = 1e4;
  family_ = family_of(strong);
  EXPECT_NEAR(sent(1e4), 28.0 * 32.767, 1e-9) << "16 bits";
  EXPECT_EQ(expected(0x607200), 32767.0);
}

TEST_F(Cia402FamilyTest, RoundingIsMadeUpForUntilTheDriveIsTakenOff) {
  constexpr double kCount = 0.028;
  const double wanted = 35.45 * kCount;
  const double first = sent(wanted);
  for (int k = 0; k < 10; ++k) {
    sent(wanted + 0.37 * k * kCount);
    static_cast<void>(family_.codec->disable());
    EXPECT_EQ(sent(wanted), first) << k;
    sent(wanted + 0.37 * k * kCount);
    CanFrame frame;
    DriveCommand command{.torque_Nm = std::nan("")};
    EXPECT_FALSE(family_.codec->command(command, {}, &frame, &command));
    EXPECT_EQ(sent(wanted), first) << k;
  }
}

TEST_F(Cia402FamilyTest, SpringAndDamperAreTheDriversOwn) {
  DriveMemory memory;
  memory.recent = true;
  memory.seen.angle_rad = 0.1;
  memory.seen.speed_rad_per_s = 0.5;
  CanFrame frame;
  DriveCommand sent;
  ASSERT_TRUE(family_.codec->command({0.2, 0.0, 50.0, 4.0, 1.0}, memory, &frame, &sent));
  EXPECT_NEAR(sent.torque_Nm, 1.0 + 50.0 * 0.1 - 4.0 * 0.5, 0.014);
  EXPECT_EQ(sent.kp_Nm_per_rad, 0.0) << "the drive knows torque alone";
  EXPECT_EQ(sent.kd_Nms_per_rad, 0.0);
  memory.seen.angle_rad = std::nan("");
  EXPECT_FALSE(family_.codec->command({0.2, 0.0, 50.0, 4.0, 1.0}, memory, &frame, &sent));
  memory.recent = false;
  EXPECT_TRUE(family_.codec->command({0.2, 0.0, 50.0, 4.0, 1.0}, memory, &frame, &sent));
}

TEST_F(Cia402FamilyTest, AStatesPartsComeOnceAndTogether) {
  family_ = family_of(plain(false), false);
  DriveReport report;
  family_.codec->begin_cycle();
  EXPECT_EQ(family_.codec->read_state(parse("583#4300100092010200"), false, &report),
            StateReading::kNone);
  EXPECT_EQ(family_.codec->read_state(parse("183#371200000100"), false, &report),
            StateReading::kPart);
  EXPECT_EQ(family_.codec->read_state(parse("183#371200000100"), false, &report),
            StateReading::kNone);
  EXPECT_EQ(family_.codec->read_state(parse("283#000000003200"), false, &report),
            StateReading::kWhole);
  EXPECT_EQ(report.status, 0x1237);
  EXPECT_NEAR(report.torque_Nm, 50.0 * 0.028, 1e-12);
}

TEST_F(Cia402FamilyTest, AnsweringWhatItIsIsPresence) {
  EXPECT_EQ(text(family_.startup->presence_request()), "603#4000100000000000");
  EXPECT_TRUE(family_.startup->is_presence(parse("583#4300100092010200")));
  EXPECT_FALSE(family_.startup->is_presence(parse("583#4B41600050020000"))) << "another object";
  EXPECT_FALSE(family_.startup->is_presence(parse("584#4300100092010200"))) << "another node";
  EXPECT_FALSE(family_.startup->is_presence(parse("183#4300100092010200")));
}

TEST_F(Cia402FamilyTest, AnEnabledDriveThatIgnoresItsTargetIsTold) {
  EXPECT_EQ(family_.codec->status_text(0x1237), "operation enabled (statusword 1237h)");
  EXPECT_EQ(family_.codec->status_text(0x0237),
            "operation enabled (statusword 0237h), but ignores its target (bit 12 is 0): halt, "
            "another mode, or a limit");
  EXPECT_EQ(family_.codec->status_text(0x0250), "switch on disabled (statusword 0250h)");
}

// --- start-up: what is expected -----------------------------------------------------------------

TEST_F(Cia402FamilyTest, ASecondForEachAnswer) {
  EXPECT_EQ(family_.startup->patience_cycles(), 1000);
  EXPECT_EQ(family_of(plain(), true, 0.3).startup->patience_cycles(), 4);
  EXPECT_EQ(family_of(plain(), true, 2.0).startup->patience_cycles(), 1);
}

TEST_F(Cia402FamilyTest, TheFirstAndLastStepAreNoObjects) {
  for (const int i : {0, family_.startup->steps() - 1}) {
    EXPECT_EQ(family_.startup->step(i).reg, 0u);
    EXPECT_EQ(family_.startup->step(i).expected, 0.0);
    EXPECT_EQ(family_.startup->step(i).answered, i != 0);
  }
}

TEST_F(Cia402FamilyTest, NumbersAsTheObjectsTypesHaveThem) {
  JointConfig joint = elastic();
  joint.drive.watchdog_s = 40.0;
  family_ = family_of(joint);
  EXPECT_EQ(expected(0x140005), 40'000.0) << "unsigned";
  EXPECT_EQ(expected(0x600700), 1.0);
  EXPECT_EQ(expected(0x605E00), 2.0);
  EXPECT_EQ(expected(0x60C201), 1.0);
  EXPECT_EQ(expected(0x60C202), -3.0) << "signed";
  EXPECT_EQ(expected(0x201001), 4.0) << "float";
  EXPECT_EQ(expected(0x201002), 5000.0);
  EXPECT_EQ(expected(0x201003), 2.0);
  EXPECT_EQ(expected(0x608F01), 65536.0);
  EXPECT_EQ(family_.startup->step(step(0x140001, true)).expected, 2147484164.0) << "80000204h";
  family_ = family_of(joint, true, 0.255);
  EXPECT_EQ(expected(0x60C201), 255.0);
}

TEST_F(Cia402FamilyTest, SignedAnswers) {
  const std::tuple<std::uint32_t, std::uint32_t, double> answers[] = {{0x60C202, 0x7F, 127.0},
                                                                      {0x60C202, 0x80, -128.0},
                                                                      {0x605E00, 0x7FFF, 32767.0},
                                                                      {0x605E00, 0x8000, -32768.0},
                                                                      {0x600700, 0x1234, 4660.0}};
  for (const auto& [reg, raw, value] : answers) {
    EXPECT_EQ(answered(reg, raw), Answer::kWrong);
    EXPECT_EQ(found_, value);
  }
}

/// 60C2h: count and exponent of ten.
TEST_F(Cia402FamilyTest, TheCycleTimeAsExactAsEightBitsAllow) {
  const std::tuple<double, double, double> periods[] = {{1e-3, 1.0, -3.0},
                                                        {5e-4, 5.0, -4.0},
                                                        {2.5e-4, 25.0, -5.0},
                                                        {1.25e-4, 125.0, -6.0},
                                                        {0.0255, 255.0, -4.0},
                                                        {1.0 / 3000.0, 33.0, -5.0},
                                                        {0.255, 255.0, -3.0},
                                                        {0.26, 255.0, -3.0},
                                                        {0.025 * (1.0 + 0.9e-6), 25.0, -3.0},
                                                        {0.025 * (1.0 + 1.05e-6), 250.0, -4.0}};
  for (const auto& [period_s, count, exponent] : periods) {
    family_ = family_of(plain(), true, period_s);
    EXPECT_EQ(expected(0x60C201), count) << period_s;
    EXPECT_EQ(expected(0x60C202), exponent) << period_s;
  }
}

TEST_F(Cia402FamilyTest, WhatIsNotDescribedIsNotRead) {
  JointConfig joint = plain();
  EXPECT_NE(step(0x201101), -1) << "a current loop";
  joint.drive.actuator.lag_s = 0.0;
  family_ = family_of(joint);
  EXPECT_EQ(step(0x201101), -1);
  EXPECT_EQ(step(0x201001), -1);
  EXPECT_EQ(step(0x60E601), -1);
  joint = elastic();
  joint.torque_loop = {};
  family_ = family_of(joint);
  EXPECT_NE(step(0x201001), -1) << "a torque sensor";
  for (const std::uint32_t loop : {0x201002u, 0x201003u, 0x201004u, 0x201005u})
    EXPECT_EQ(step(loop), -1) << loop;
}

// --- start-up: what is answered -----------------------------------------------------------------

TEST_F(Cia402FamilyTest, OnlyTheAnswerToAStepCounts) {
  const int rated = step(0x607600);
  EXPECT_EQ(check(rated, reply(rated, 28'000)), Answer::kRight);
  EXPECT_EQ(check(rated, reply(step(0x607200), 28'000)), Answer::kNone) << "another object";
  EXPECT_EQ(check(rated, parse("584#4376600060600000")), Answer::kNone) << "another node";
  EXPECT_EQ(check(rated, parse("183#371200000100")), Answer::kNone);
  const int written = step(0x607200, true);
  EXPECT_EQ(check(written, reply(written, 0)), Answer::kRight);
  EXPECT_EQ(check(step(0x607200), reply(written, 0)), Answer::kNone) << "written, not read";
  EXPECT_EQ(check(written, reply(step(0x607200), 500)), Answer::kNone);
}

TEST_F(Cia402FamilyTest, BitsThatDoNotMatterAreNotCompared) {
  EXPECT_EQ(answered(0x650200, 0x3FF), Answer::kRight);
  EXPECT_EQ(answered(0x650200, 0x1FF), Answer::kWrong) << "bit 9: cyclic synchronous torque";
  EXPECT_EQ(answered(0x100000, 0xFFFF0192), Answer::kRight);
  EXPECT_EQ(answered(0x100000, 0x00020193), Answer::kWrong);
  EXPECT_EQ(found_, 403.0);
  EXPECT_EQ(answered(0x604100, 0x0250), Answer::kRight);
  for (const std::uint32_t powered : {0x0231u, 0x0252u, 0x0254u})
    EXPECT_EQ(answered(0x604100, powered), Answer::kNotYet) << powered;
}

TEST_F(Cia402FamilyTest, StatesAnswerTheStart) {
  family_ = family_of(plain(false), false);
  const int start = family_.startup->steps() - 1;
  EXPECT_EQ(check(start, parse("583#4300100092010200")), Answer::kNone);
  EXPECT_EQ(check(start, parse("183#371200000100")), Answer::kNotYet);
  EXPECT_EQ(check(start, parse("283#000000003200")), Answer::kRight);
  EXPECT_EQ(found_, 0.0);
}

TEST_F(Cia402FamilyTest, WhichObjectsMayBeMissing) {
  family_ = family_of(elastic());
  const std::set<std::uint32_t> warned = {0x140005, 0x600700, 0x605E00, 0x60C201, 0x60C202};
  const std::set<std::uint32_t> silent = {0x608F02, 0x609101, 0x180101, 0x180201, 0x180301};
  for (int i = 1; i + 1 < family_.startup->steps(); ++i) {
    const std::uint32_t reg = family_.startup->step(i).reg;
    if (reg == 0x609102) continue;  // the last of the counts: all are compared
    for (const std::uint32_t code : {kNoSuchObject, kNoSuchSub}) {
      const Answer expected = warned.count(reg) != 0   ? Answer::kMissing
                              : silent.count(reg) != 0 ? Answer::kRight
                                                       : Answer::kRefused;
      EXPECT_EQ(check(i, abort(i, code)), expected) << std::hex << reg;
      if (expected == Answer::kRefused) {
        EXPECT_EQ(found_, code);
      }
    }
    EXPECT_EQ(check(i, abort(i, kReadOnly)), Answer::kRefused) << std::hex << reg;
    EXPECT_EQ(found_, kReadOnly);
  }
}

TEST_F(Cia402FamilyTest, CountsATurnOfFourNumbers) {
  const auto counted = [this](std::uint32_t counts, std::uint32_t turns, std::uint32_t motor,
                              std::uint32_t joint) {
    EXPECT_EQ(answered(0x608F01, counts), Answer::kRight);
    EXPECT_EQ(answered(0x608F02, turns), Answer::kRight);
    EXPECT_EQ(answered(0x609101, motor), Answer::kRight);
    return answered(0x609102, joint);
  };
  EXPECT_EQ(counted(65536, 1, 1, 1), Answer::kRight);
  EXPECT_EQ(counted(16384, 2, 24, 3), Answer::kRight);
  EXPECT_EQ(counted(65536, 1, 1, 2), Answer::kWrong);
  EXPECT_EQ(found_, 32768.0);
  EXPECT_EQ(answered(0x608F01, 65536), Answer::kRight);
  for (const std::uint32_t missing : {0x608F02u, 0x609101u, 0x609102u})
    EXPECT_EQ(check(step(missing), abort(step(missing), kNoSuchObject)), Answer::kRight);
  EXPECT_EQ(found_, 65536.0) << "each of them is 1";
  JointConfig fine = plain();
  fine.drive.counts_per_turn = 4e9;
  family_ = family_of(fine);
  EXPECT_EQ(counted(4'000'000'004, 1, 1, 1), Answer::kRight) << "a thousand-millionth";
  EXPECT_EQ(counted(4'000'000'005, 1, 1, 1), Answer::kWrong);
  for (const double off : {0.95e-9, 1.05e-9}) {
    JointConfig joint = plain();
    joint.drive.counts_per_turn = 65536.0 / (1.0 + off);
    family_ = family_of(joint);
    EXPECT_EQ(counted(65536, 1, 1, 1), off < 1e-9 ? Answer::kRight : Answer::kWrong) << off;
  }
}

}  // namespace
}  // namespace limber::test_cia402_family
