// candump's log format against lines that can-utils writes, and everything that is none.
#include <gtest/gtest.h>

#include <string>

#include "common/config_error.h"
#include "drivers/can/candump_log.h"
#include "tests/support/mutation.h"

namespace limber::test_candump_log {
namespace {

LoggedFrame parsed(const std::string& line) {
  LoggedFrame logged;
  EXPECT_TRUE(from_candump(line, &logged)) << line;
  return logged;
}

TEST(CandumpLog, ReadsAClassicFrame) {
  const LoggedFrame logged = parsed("(1436509052.249713) vcan0 044#2A366C2BBA");
  EXPECT_EQ(logged.time_ns, 1436509052'249'713'000);
  EXPECT_EQ(logged.interface, "vcan0");
  EXPECT_EQ(logged.frame.id, 0x44U);
  EXPECT_FALSE(logged.frame.extended || logged.frame.fd || logged.frame.remote);
  ASSERT_EQ(logged.frame.length, 5);
  EXPECT_EQ(logged.frame.data[0], 0x2A);
  EXPECT_EQ(logged.frame.data[4], 0xBA);
}

TEST(CandumpLog, EightDigitsAreAnExtendedIdentifierOrAnErrorFrame) {
  const CanFrame extended = parsed("(0.5) can0 00008001#").frame;
  EXPECT_TRUE(extended.extended);
  EXPECT_EQ(extended.id, 0x8001U);
  const CanFrame error = parsed("(0.5) can0 20000040#0000000000000000").frame;
  EXPECT_TRUE(error.error);
  EXPECT_FALSE(error.extended);
  EXPECT_EQ(error.id, 0x40U);
}

TEST(CandumpLog, ReadsFdAndRemoteFrames) {
  const CanFrame fast = parsed("(0) can0 123##111223344556677889900AABB").frame;
  EXPECT_TRUE(fast.fd);
  EXPECT_TRUE(fast.bitrate_switch);
  EXPECT_EQ(fast.length, 12);
  EXPECT_FALSE(parsed("(0) can0 123##0").frame.bitrate_switch);
  EXPECT_EQ(parsed("(0) can0 123#R").frame.length, 0);
  const CanFrame remote = parsed("(0) can0 123#R4").frame;
  EXPECT_TRUE(remote.remote);
  EXPECT_EQ(remote.length, 4);
}

TEST(CandumpLog, LetsPassWhatOtherVersionsAdd) {
  EXPECT_EQ(parsed("(1.000000001) can0 123#11 T").time_ns, 1'000'000'001);  // -N, -x
  EXPECT_EQ(parsed("(1.0)  can0  123#11.22  R\r").frame.length, 2);
  EXPECT_EQ(parsed("(1.0) can0 123#1122334455667788_F").frame.length, 8);
}

TEST(CandumpLog, RefusesWhatNoBusCarries) {
  LoggedFrame logged;
  for (const char* line :
       {"", "(1.0 can0 123#11", "(x) can0 123#11", "(-1) can0 123#11", "(1.) can0 123#11",
        "(1.0) 123#11", "(1.0) can0 1234#11", "(1.0) can0 12X#11", "(1.0) can0 8FF#11",
        "(1.0) can0 123#112", "(1.0) can0 123#112233445566778899", "(1.0) can0 123##",
        "(1.0) can0 123##1112233445566778899",  // nine bytes: no length of FD
        "(1.0) can0 123#11 22", "(1.0) can0 123#R9", "(1.0) can0 FFFFFFFF#", "(nan) can0 123#",
        "(99999999999999999999) can0 123#", "(9223372036.9) can0 123#"})
    EXPECT_FALSE(from_candump(line, &logged)) << line;
}

TEST(CandumpLog, WhatIsWrittenIsReadAgain) {
  for (const char* line :
       {"(0.000000) openarm 001#FFFFFFFFFFFFFFFC", "(12.345678) can0 00008001##1010000",
        "(0.000001) can1 20000004#0004000000000000", "(3.000000) can0 7FF#R",
        "(3.100000) can0 7FF#R8", "(1436509052.249713) can0 080#"})
    EXPECT_EQ(to_candump(parsed(line)), line);
}

TEST(CandumpLog, AFilesComplaintNamesTheLine) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("x.log", "(1.0) can0 123#11\n\n(1.0) can0 nonsense\n");
  CandumpReader reader(path);
  LoggedFrame logged;
  ASSERT_TRUE(reader.next(&logged));
  try {
    static_cast<void>(reader.next(&logged));
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("x.log:3"), std::string::npos) << error.what();
  }
  EXPECT_THROW(CandumpReader(folder.path() + "/missing.log"), ConfigError);
  EXPECT_THROW(CandumpWriter(folder.path() + "/missing/x.log"), ConfigError);
}

}  // namespace
}  // namespace limber::test_candump_log
