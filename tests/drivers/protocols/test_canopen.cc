// Bytes of CANopen (CiA 301) against frames composed by hand, for node 3 where nothing else is
// said.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "drivers/protocols/canopen.h"
#include "drivers/protocols/canopen_sdo.h"
#include "tests/support/frame_text.h"
#include "tools/allocations/allocations.h"

namespace limber::canopen::test_canopen {
namespace {

using limber::testing::parse;
using limber::testing::text;

// --- network management, heartbeat, SYNC, emergency ---

TEST(CanopenNmt, Commands) {
  EXPECT_EQ(text(encode_nmt(NmtCommand::kStart, 3)), "000#0103");
  EXPECT_EQ(text(encode_nmt(NmtCommand::kPreOperational, 0)), "000#8000");
  NmtCommand command = NmtCommand::kStop;
  EXPECT_TRUE(decode_nmt(parse("000#0103"), 3, &command));
  EXPECT_EQ(command, NmtCommand::kStart);
  EXPECT_TRUE(decode_nmt(parse("000#8100"), 3, &command));
  EXPECT_EQ(command, NmtCommand::kResetNode);
  for (const char* other : {"000#0104", "000#0303", "000#01", "000#010300", "001#0103"})
    EXPECT_FALSE(decode_nmt(parse(other), 3, &command)) << other;
}

TEST(CanopenHeartbeat, States) {
  EXPECT_EQ(text(encode_heartbeat(NmtState::kBootUp, 3)), "703#00");
  EXPECT_EQ(text(encode_heartbeat(NmtState::kOperational, 3)), "703#05");
  NmtState state = NmtState::kBootUp;
  EXPECT_TRUE(decode_heartbeat(parse("703#7F"), 3, &state));
  EXPECT_EQ(state, NmtState::kPreOperational);
  for (const char* other : {"704#7F", "703#06", "703#", "703#0505"})
    EXPECT_FALSE(decode_heartbeat(parse(other), 3, &state)) << other;
}

TEST(CanopenSync, WithAndWithoutCounter) {
  EXPECT_EQ(text(encode_sync()), "080#");
  EXPECT_EQ(text(encode_sync(7)), "080#07");
}

TEST(CanopenEmergency, HeartbeatLostAndCleared) {
  EXPECT_EQ(text(encode_emergency({kHeartbeatLost, kErrorGeneric | kErrorCommunication, {}}, 3)),
            "083#3081110000000000");
  EXPECT_EQ(text(encode_emergency({}, 3)), "083#0000000000000000");
  Emergency emergency;
  ASSERT_TRUE(decode_emergency(parse("083#1023020102030405"), 3, &emergency));
  EXPECT_EQ(emergency.code, kOverCurrent);
  EXPECT_EQ(emergency.error_register, kErrorCurrent);
  EXPECT_EQ(emergency.vendor, (std::array<std::uint8_t, 5>{1, 2, 3, 4, 5}));
  EXPECT_FALSE(decode_emergency(parse("083#10230201020304"), 3, &emergency));
  // SYNC has the identifier that an emergency of node 0 would have.
  EXPECT_FALSE(decode_emergency(parse("080#1023020102030405"), 0, &emergency));
}

// --- fields ---

TEST(CanopenFields, LittleEndianOneBehindTheOther) {
  FieldWriter writer(0x183, false);
  writer.put(0x1637, 2);
  writer.put(81920, 4);
  writer.put(static_cast<std::uint32_t>(-15), 2);
  writer.put(0xFF, 1);  // no room
  EXPECT_EQ(text(writer.frame()), "183#371600400100F1FF");
  EXPECT_FALSE(writer.frame().fd);
}

TEST(CanopenFields, FdFramesArePaddedWithZeros) {
  FieldWriter writer(0x183, true);
  for (std::uint32_t i = 1; i <= 9; ++i) writer.put(i, 1);
  EXPECT_EQ(text(writer.frame()), "183#010203040506070809000000");
  EXPECT_TRUE(writer.frame().fd && writer.frame().bitrate_switch);
}

TEST(CanopenFields, ReadingSignsAndEnds) {
  const CanFrame frame = parse("183#371600400100F1FF");
  FieldReader reader(frame);
  EXPECT_EQ(reader.take(2), 0x1637U);
  EXPECT_EQ(reader.take_signed(4), 81920);
  EXPECT_EQ(reader.take_signed(2), -15);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.take(1), 0U);
  EXPECT_FALSE(reader.complete());
}

TEST(CanopenObject, MappingEntries) {
  EXPECT_EQ((Object{{0x6041, 0}, 2}.mapping()), 0x60410010U);
  EXPECT_EQ((Object{{0x60E4, 1}, 4}.mapping()), 0x60E40120U);
  EXPECT_EQ((ObjectId{0x1400, 5}.number()), 0x140005U);
  EXPECT_EQ(node_of(0x183), 3);
}

// --- SDO ---

TEST(CanopenSdo, RequestsOfAClient) {
  EXPECT_EQ(text(encode_sdo_write({{0x6060, 0}, 1}, 10, 3)), "603#2F6060000A000000");
  EXPECT_EQ(text(encode_sdo_write({{0x6040, 0}, 2}, 6, 3)), "603#2B40600006000000");
  EXPECT_EQ(text(encode_sdo_write({{0x6040, 0}, 2}, 7, 3)), "603#2B40600007000000");
  EXPECT_EQ(text(encode_sdo_write({{0x6040, 0}, 2}, 15, 3)), "603#2B4060000F000000");
  EXPECT_EQ(text(encode_sdo_read({0x6076, 0}, 3)), "603#4076600000000000");
  // Negative values keep to their length.
  EXPECT_EQ(text(encode_sdo_write({{0x6071, 0}, 2}, static_cast<std::uint32_t>(-15), 3)),
            "603#2B716000F1FF0000");
}

TEST(CanopenSdo, MappingOfAPdo) {
  EXPECT_EQ(text(encode_sdo_write(pdo_cob_id(kTpdoCommunication), 0x183U | kPdoDisabled, 3)),
            "603#2300180183010080");
  EXPECT_EQ(text(encode_sdo_write(pdo_mapped_count(kTpdoMapping), 0, 3)), "603#2F001A0000000000");
  EXPECT_EQ(
      text(encode_sdo_write(pdo_mapped(kTpdoMapping, 1), Object{{0x6041, 0}, 2}.mapping(), 3)),
      "603#23001A0110004160");
  EXPECT_EQ(
      text(encode_sdo_write(pdo_mapped(kTpdoMapping, 2), Object{{0x6064, 0}, 4}.mapping(), 3)),
      "603#23001A0220006460");
  EXPECT_EQ(
      text(encode_sdo_write(pdo_mapped(kTpdoMapping, 3), Object{{0x6077, 0}, 2}.mapping(), 3)),
      "603#23001A0310007760");
  EXPECT_EQ(text(encode_sdo_write(pdo_mapped_count(kTpdoMapping), 3, 3)), "603#2F001A0003000000");
  EXPECT_EQ(text(encode_sdo_write(pdo_type(kTpdoCommunication), 1, 3)), "603#2F00180201000000");
  EXPECT_EQ(text(encode_sdo_write(pdo_cob_id(kTpdoCommunication), 0x183, 3)),
            "603#2300180183010000");
}

TEST(CanopenSdo, AnswersToAClient) {
  SdoMessage answer;
  ASSERT_TRUE(decode_sdo_answer(parse("583#6060600000000000"), 3, &answer));
  EXPECT_EQ(answer.kind, SdoKind::kWrite);
  EXPECT_EQ(answer.object, (ObjectId{0x6060, 0}));

  ASSERT_TRUE(decode_sdo_answer(parse("583#43766000606D0000"), 3, &answer));
  EXPECT_EQ(answer.kind, SdoKind::kRead);
  EXPECT_EQ(answer.object, (ObjectId{0x6076, 0}));
  EXPECT_EQ(answer.value, 28000U);
  EXPECT_EQ(answer.bytes, 4);

  ASSERT_TRUE(decode_sdo_answer(parse("583#4F616000AABBCCDD"), 3, &answer));
  EXPECT_EQ(answer.value, 0xAAU);  // the other three bytes say nothing
  EXPECT_EQ(answer.bytes, 1);

  ASSERT_TRUE(decode_sdo_answer(parse("583#8041600002000106"), 3, &answer));
  EXPECT_EQ(answer.kind, SdoKind::kAbort);
  EXPECT_EQ(static_cast<SdoAbort>(answer.value), SdoAbort::kReadOnly);
  EXPECT_STREQ(text_of(SdoAbort::kReadOnly), "object is read only");
  EXPECT_STREQ(text_of(static_cast<SdoAbort>(0x12345678)), "unknown abort code");

  for (const char* other : {"584#6060600000000000", "583#60606000000000", "603#6060600000000000"})
    EXPECT_FALSE(decode_sdo_answer(parse(other), 3, &answer)) << other;
}

TEST(CanopenSdo, AnswersOfANode) {
  EXPECT_EQ(text(encode_sdo_answer({SdoKind::kWrite, {0x6060, 0}}, 3)), "583#6060600000000000");
  EXPECT_EQ(text(encode_sdo_answer({SdoKind::kRead, {0x6076, 0}, 28000, 4}, 3)),
            "583#43766000606D0000");
  EXPECT_EQ(text(encode_sdo_answer({SdoKind::kRead, {0x6041, 0}, 0x250, 2}, 3)),
            "583#4B41600050020000");
  EXPECT_EQ(text(encode_sdo_answer({SdoKind::kRead, {0x6041, 0}, 0x250, 3}, 3)),
            "583#4741600050020000");
  EXPECT_EQ(text(encode_sdo_answer({SdoKind::kRead, {0x6041, 0}, 0x250, 0}, 3)),
            "583#4241600050020000");
  EXPECT_EQ(text(encode_sdo_answer({SdoKind::kAbort, {0x6041, 0}, 0x06010002}, 3)),
            "583#8041600002000106");
}

TEST(CanopenSdo, RequestsAsANodeHearsThem) {
  SdoMessage request;
  ASSERT_TRUE(decode_sdo_request(parse("603#2B41600001000000"), 3, &request));
  EXPECT_EQ(request.kind, SdoKind::kWrite);
  EXPECT_EQ(request.bytes, 2);
  EXPECT_EQ(request.value, 1U);
  ASSERT_TRUE(decode_sdo_request(parse("603#2241600001020304"), 3, &request));
  EXPECT_EQ(request.bytes, 0);  // size not given
  EXPECT_EQ(request.value, 0x04030201U);
  ASSERT_TRUE(decode_sdo_request(parse("603#4041600000000000"), 3, &request));
  EXPECT_EQ(request.kind, SdoKind::kRead);
  ASSERT_TRUE(decode_sdo_request(parse("603#A441600000000000"), 3, &request));
  EXPECT_EQ(request.kind, SdoKind::kUnknown);  // block upload
}

TEST(CanopenSdo, SegmentsBothWays) {
  // "limber" and "bench" written: 11 bytes in two segments, 7 and 4.
  EXPECT_EQ(text(encode_sdo_request({SdoKind::kStartWrite, {0x6403, 0}, 11}, 3)),
            "603#210364000B000000");
  SdoMessage first = {SdoKind::kWriteSegment, {}, 0, 7, false, false, {1, 2, 3, 4, 5, 6, 7}};
  SdoMessage second = {SdoKind::kWriteSegment, {}, 0, 4, true, true, {8, 9, 10, 11}};
  EXPECT_EQ(text(encode_sdo_request(first, 3)), "603#0001020304050607");
  EXPECT_EQ(text(encode_sdo_request(second, 3)), "603#1708090A0B000000");
  EXPECT_EQ(text(encode_sdo_answer(first, 3)), "583#2000000000000000");
  EXPECT_EQ(text(encode_sdo_answer(second, 3)), "583#3000000000000000");

  EXPECT_EQ(text(encode_sdo_answer({SdoKind::kStartRead, {0x1008, 0}, 11}, 3)),
            "583#410810000B000000");
  first.kind = second.kind = SdoKind::kReadSegment;
  EXPECT_EQ(text(encode_sdo_request(first, 3)), "603#6000000000000000");
  EXPECT_EQ(text(encode_sdo_request(second, 3)), "603#7000000000000000");
  EXPECT_EQ(text(encode_sdo_answer(second, 3)), "583#1708090A0B000000");

  SdoMessage heard;
  ASSERT_TRUE(decode_sdo_answer(parse("583#1708090A0B000000"), 3, &heard));
  EXPECT_EQ(heard.kind, SdoKind::kReadSegment);
  EXPECT_TRUE(heard.toggle && heard.last);
  EXPECT_EQ(heard.bytes, 4);
  EXPECT_EQ(heard.segment, (std::array<std::uint8_t, 7>{8, 9, 10, 11}));
  ASSERT_TRUE(decode_sdo_answer(parse("583#410810000B000000"), 3, &heard));
  EXPECT_EQ(heard.kind, SdoKind::kStartRead);
  EXPECT_EQ(heard.value, 11U);
  ASSERT_TRUE(decode_sdo_request(parse("603#210364000B000000"), 3, &heard));
  EXPECT_EQ(heard.kind, SdoKind::kStartWrite);
  EXPECT_EQ(heard.value, 11U);
  ASSERT_TRUE(decode_sdo_request(parse("603#7000000000000000"), 3, &heard));
  EXPECT_EQ(heard.kind, SdoKind::kReadSegment);
  EXPECT_TRUE(heard.toggle);
}

TEST(CanopenSdo, EveryFirstByteIsDecodedOrKnownAsUnknown) {
  int kinds[8] = {};
  SdoMessage message;
  for (int byte = 0; byte < 256; ++byte) {
    CanFrame frame = parse("603#0041600000000000");
    frame.data[0] = static_cast<std::uint8_t>(byte);
    ASSERT_TRUE(decode_sdo_request(frame, 3, &message));
    ASSERT_LE(message.bytes, 7);
    ++kinds[static_cast<int>(message.kind)];
  }
  // Of 32 first bytes for each of the eight commands, those of a start are half expedited.
  EXPECT_EQ(kinds[static_cast<int>(SdoKind::kWrite)], 16);
  EXPECT_EQ(kinds[static_cast<int>(SdoKind::kStartWrite)], 16);
  EXPECT_EQ(kinds[static_cast<int>(SdoKind::kRead)], 32);
  EXPECT_EQ(kinds[static_cast<int>(SdoKind::kWriteSegment)], 32);
  EXPECT_EQ(kinds[static_cast<int>(SdoKind::kReadSegment)], 32);
  EXPECT_EQ(kinds[static_cast<int>(SdoKind::kAbort)], 32);
  EXPECT_EQ(kinds[static_cast<int>(SdoKind::kUnknown)], 96);
}

TEST(Canopen, NeverAllocates) {
  const std::int64_t before = allocations();
  SdoMessage message;
  Emergency emergency;
  EXPECT_TRUE(decode_sdo_request(encode_sdo_read({0x6076, 0}, 3), 3, &message));
  EXPECT_TRUE(decode_sdo_answer(encode_sdo_answer(message, 3), 3, &message));
  EXPECT_TRUE(decode_emergency(encode_emergency({}, 3), 3, &emergency));
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace limber::canopen::test_canopen
