// SDO frames by their bytes (CiA 301): every command, its bits, and what is no SDO.
#include <gtest/gtest.h>

#include <string>

#include "drivers/protocols/canopen_sdo.h"
#include "tests/support/frame_text.h"

namespace limber::test_sdo_bytes {
namespace {

using namespace canopen;
using testing::parse;
using testing::text;

constexpr std::uint8_t kNode = 5;
constexpr ObjectId kObject{0x6072, 3};

std::string request(const SdoMessage& message) { return text(encode_sdo_request(message, kNode)); }
std::string answer(const SdoMessage& message) { return text(encode_sdo_answer(message, kNode)); }

/// Of whatever was in the message before nothing must be left.
SdoMessage used() {
  SdoMessage message{SdoKind::kAbort, {0x1111, 0x22}, 0x33333333, 4, true, true, {}};
  message.segment.fill(0x44);
  return message;
}
SdoMessage requested(const std::string& candump) {
  SdoMessage message = used();
  EXPECT_TRUE(decode_sdo_request(parse(candump), kNode, &message));
  return message;
}
SdoMessage answered(const std::string& candump) {
  SdoMessage message = used();
  EXPECT_TRUE(decode_sdo_answer(parse(candump), kNode, &message));
  return message;
}
void expect_start(const SdoMessage& message, SdoKind kind, std::uint32_t value, int bytes) {
  EXPECT_EQ(message.kind, kind);
  EXPECT_EQ(message.object, kObject);
  EXPECT_EQ(message.value, value);
  EXPECT_EQ(message.bytes, bytes);
  EXPECT_FALSE(message.toggle || message.last);
}

TEST(SdoBytes, ExpeditedValues) {
  EXPECT_EQ(request({SdoKind::kWrite, kObject, 0x12, 1}), "605#2F72600312000000");
  EXPECT_EQ(request({SdoKind::kWrite, kObject, 0x1234, 2}), "605#2B72600334120000");
  EXPECT_EQ(request({SdoKind::kWrite, kObject, 0x123456, 3}), "605#2772600356341200");
  EXPECT_EQ(request({SdoKind::kWrite, kObject, 0x12345678, 4}), "605#2372600378563412");
  EXPECT_EQ(request({SdoKind::kWrite, kObject, 0x12345678, 9}), "605#2372600378563412");
  EXPECT_EQ(request({SdoKind::kWrite, kObject, 0x12, 0}), "605#2272600312000000") << "no size";
  EXPECT_EQ(request({SdoKind::kRead, kObject, 0x12, 1}), "605#4072600300000000");
  EXPECT_EQ(answer({SdoKind::kRead, kObject, 0x1234, 2}), "585#4B72600334120000");
  EXPECT_EQ(answer({SdoKind::kWrite, kObject, 0x1234, 2}), "585#6072600300000000");
  expect_start(requested("605#2F726003FFFFFFFF"), SdoKind::kWrite, 0xFF, 1);
  expect_start(requested("605#2B726003FFFFFFFF"), SdoKind::kWrite, 0xFFFF, 2);
  expect_start(requested("605#27726003FFFFFFFF"), SdoKind::kWrite, 0xFFFFFF, 3);
  expect_start(requested("605#23726003FFFFFFFF"), SdoKind::kWrite, 0xFFFFFFFF, 4);
  expect_start(requested("605#22726003FFFFFFFF"), SdoKind::kWrite, 0xFFFFFFFF, 0);
  expect_start(requested("605#4072600300000000"), SdoKind::kRead, 0, 0);
  expect_start(answered("585#47726003FFFFFFFF"), SdoKind::kRead, 0xFFFFFF, 3);
  expect_start(answered("585#6072600300000000"), SdoKind::kWrite, 0, 0);
}

TEST(SdoBytes, ValuesAreCutToTheObjectsBytes) {
  const auto write = [](std::uint8_t bytes) {
    return text(encode_sdo_write({kObject, bytes}, 0xFFFFFFFE, kNode));
  };
  EXPECT_EQ(write(1), "605#2F726003FE000000");
  EXPECT_EQ(write(2), "605#2B726003FEFF0000");
  EXPECT_EQ(write(3), "605#27726003FEFFFF00");
  EXPECT_EQ(write(4), "605#23726003FEFFFFFF");
}

TEST(SdoBytes, SegmentsAreAnnouncedWithTheirSizeOrWithout) {
  EXPECT_EQ(request({SdoKind::kStartWrite, kObject, 20}), "605#2172600314000000");
  EXPECT_EQ(request({SdoKind::kStartWrite, kObject, 1}), "605#2172600301000000");
  EXPECT_EQ(request({SdoKind::kStartWrite, kObject, 0}), "605#2072600300000000");
  EXPECT_EQ(answer({SdoKind::kStartRead, kObject, 20}), "585#4172600314000000");
  expect_start(requested("605#2172600314000000"), SdoKind::kStartWrite, 20, 0);
  expect_start(requested("605#2072600314000000"), SdoKind::kStartWrite, 0, 0);
  expect_start(answered("585#4172600314000000"), SdoKind::kStartRead, 20, 0);
  expect_start(answered("585#4072600314000000"), SdoKind::kStartRead, 0, 0);
}

TEST(SdoBytes, Segments) {
  SdoMessage segment{SdoKind::kWriteSegment, {}, 0, 3, false, false, {1, 2, 3, 4, 5, 6, 7}};
  EXPECT_EQ(request(segment), "605#0801020300000000");
  segment.toggle = segment.last = true;
  EXPECT_EQ(request(segment), "605#1901020300000000");
  segment.bytes = 7;
  EXPECT_EQ(request(segment), "605#1101020304050607");
  segment.bytes = 8;
  EXPECT_EQ(request(segment), "605#1101020304050607") << "seven at most";
  segment.kind = SdoKind::kReadSegment;
  segment.last = false;
  segment.bytes = 2;
  EXPECT_EQ(answer(segment), "585#1A01020000000000");
  EXPECT_EQ(request({SdoKind::kReadSegment, {}}), "605#6000000000000000");
  EXPECT_EQ(answer({SdoKind::kWriteSegment, {}}), "585#2000000000000000");
  segment.kind = SdoKind::kWriteSegment;
  EXPECT_EQ(answer(segment), "585#3000000000000000");
  segment.kind = SdoKind::kReadSegment;
  EXPECT_EQ(request(segment), "605#7000000000000000");

  const SdoMessage written = requested("605#1901020304050607");
  EXPECT_EQ(written.kind, SdoKind::kWriteSegment);
  EXPECT_TRUE(written.toggle && written.last);
  EXPECT_EQ(written.bytes, 3);
  EXPECT_EQ(written.segment, (std::array<std::uint8_t, 7>{1, 2, 3}));
  const SdoMessage read = answered("585#0001020304050607");
  EXPECT_EQ(read.kind, SdoKind::kReadSegment);
  EXPECT_FALSE(read.toggle || read.last);
  EXPECT_EQ(read.bytes, 7);
  EXPECT_EQ(read.segment, (std::array<std::uint8_t, 7>{1, 2, 3, 4, 5, 6, 7}));
  EXPECT_TRUE(answered("585#1001020304050607").toggle);
  EXPECT_FALSE(answered("585#0E01020304050607").last) << "bits of the length";
  EXPECT_EQ(requested("605#7000000000000000").kind, SdoKind::kReadSegment);
  EXPECT_TRUE(requested("605#7000000000000000").toggle);
  EXPECT_FALSE(requested("605#6F00000000000000").toggle) << "bit 4 alone";
  EXPECT_EQ(answered("585#3000000000000000").kind, SdoKind::kWriteSegment);
  EXPECT_TRUE(answered("585#3000000000000000").toggle);
  EXPECT_FALSE(answered("585#2F00000000000000").toggle);
}

TEST(SdoBytes, Aborts) {
  EXPECT_EQ(request({SdoKind::kAbort, kObject, 0x06020000}), "605#8072600300000206");
  EXPECT_EQ(answer({SdoKind::kAbort, kObject, 0x06020000}), "585#8072600300000206");
  expect_start(requested("605#8072600300000206"), SdoKind::kAbort, 0x06020000, 0);
  expect_start(answered("585#8072600300000206"), SdoKind::kAbort, 0x06020000, 0);
  EXPECT_EQ(requested("605#A072600300000000").kind, SdoKind::kUnknown) << "a block transfer";
  EXPECT_EQ(answered("585#A072600300000000").kind, SdoKind::kUnknown);
}

TEST(SdoBytes, OtherFramesAreNone) {
  const auto is_request = [](const CanFrame& frame) {
    SdoMessage message;
    return decode_sdo_request(frame, kNode, &message);
  };
  EXPECT_FALSE(is_request(parse("606#4072600300000000")));
  EXPECT_FALSE(is_request(parse("585#4072600300000000")));
  EXPECT_FALSE(is_request(parse("605#40726003000000")));
  CanFrame remote = parse("605#4072600300000000");
  remote.remote = true;
  EXPECT_FALSE(is_request(remote));
}

TEST(SdoBytes, StartsAndPartsOfWritesAreWrites) {
  const auto writes = [](const std::string& candump) { return is_sdo_write(parse(candump)); };
  EXPECT_TRUE(writes("605#2F72600312000000"));
  EXPECT_TRUE(writes("605#2172600314000000"));
  EXPECT_TRUE(writes("605#0001020304050607")) << "a segment";
  EXPECT_TRUE(writes("605#1901020304050607"));
  EXPECT_TRUE(writes("605#C672600314000000")) << "a block";
  for (const char* other : {"605#4072600300000000", "605#6000000000000000", "605#8072600300000206",
                            "605#A472600300000000", "605#E000000000000000", "605#4020600300000000"})
    EXPECT_FALSE(writes(other)) << other;
  EXPECT_FALSE(writes("605#2F726003120000")) << "seven bytes";
  CanFrame longer = parse("605#2F72600312000000");
  longer.length = 12;
  EXPECT_FALSE(is_sdo_write(longer));
  CanFrame remote = parse("605#2F72600312000000");
  remote.remote = true;
  EXPECT_FALSE(is_sdo_write(remote));
}

}  // namespace
}  // namespace limber::test_sdo_bytes
