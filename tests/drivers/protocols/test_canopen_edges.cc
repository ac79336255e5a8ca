// CANopen: emergencies in words, places of the PDO records, fields at the end of a frame.
#include <gtest/gtest.h>

#include "drivers/protocols/canopen.h"
#include "tests/support/frame_text.h"

namespace limber::test_canopen_edges {
namespace {

using namespace canopen;
using testing::parse;
using testing::text;

TEST(CanopenEmergencies, CodesAndClassesInWords) {
  const std::pair<int, const char*> texts[] = {
      {0x0000, "all errors are gone"},
      {0x0001, "unknown"},
      {0x1000, "generic"},
      {0x2310, "over-current"},
      {0x2311, "current"},
      {0x2000, "current"},
      {0x3210, "over-voltage"},
      {0x3220, "under-voltage"},
      {0x3F00, "voltage"},
      {0x4310, "drive too hot"},
      {0x4210, "temperature"},
      {0x5530, "hardware"},
      {0x6100, "software"},
      {0x7305, "added modules"},
      {0x8130, "heartbeat lost"},
      {0x8110, "communication"},
      {0x8100, "communication"},
      {0x81FF, "communication"},
      {0x8000, "monitoring"},
      {0x8200, "monitoring"},
      {0x8210, "PDO too short"},
      {0x8240, "SYNC of unexpected length"},
      {0x8250, "RPDO time-out"},
      {0x9000, "external"},
      {0xA000, "unknown"},
      {0xF123, "manufacturer"},
      {0xFF01, "manufacturer"},
  };
  for (const auto& [code, words] : texts)
    EXPECT_STREQ(emergency_text(static_cast<std::uint16_t>(code)), words) << std::hex << code;
}

TEST(CanopenEmergencies, FiveBytesAreTheMakers) {
  EXPECT_EQ(text(encode_emergency({0x8250, 0x11, {1, 2, 3, 4, 5}}, 5)), "085#5082110102030405");
  CanFrame remote = parse("085#5082110102030405");
  Emergency emergency;
  EXPECT_TRUE(decode_emergency(remote, 5, &emergency));
  remote.remote = true;
  EXPECT_FALSE(decode_emergency(remote, 5, &emergency));
}

// CiA 301: sub 1 u32, 2 u8, 3 u16, 5 u16; mapping records count in sub 0.
TEST(CanopenRecords, PlacesAndLengths) {
  const auto is = [](const Object& object, int index, int sub, int bytes) {
    EXPECT_EQ(object.id.index, index);
    EXPECT_EQ(object.id.sub, sub);
    EXPECT_EQ(object.bytes, bytes);
  };
  std::uint16_t record = 0x1800;
  is(pdo_cob_id(record), 0x1800, 1, 4);
  is(pdo_type(record), 0x1800, 2, 1);
  is(pdo_inhibit_time(record), 0x1800, 3, 2);
  is(pdo_event_timer_ms(record), 0x1800, 5, 2);
  record = 0x1A00;
  is(pdo_mapped_count(record), 0x1A00, 0, 1);
  is(pdo_mapped(record, 7), 0x1A00, 7, 4);
  is(Object{}, 0, 0, 0);
}

TEST(CanopenFields, WhatDoesNotFitIsLeftOut) {
  for (const bool fd : {false, true}) {
    const int most = fd ? 64 : 8;
    FieldWriter writer(0x185, fd);
    for (int i = 0; i < most / 4; ++i) writer.put(0x01010101, 4);
    writer.put(0xFF, 1);
    EXPECT_EQ(writer.frame().length, most);
    FieldWriter other(0x185, fd);
    for (int i = 0; i < most - 1; ++i) other.put(1, 1);
    other.put(0xFFFF, 2);
    CanFrame frame = other.frame();
    EXPECT_EQ(frame.data[static_cast<std::size_t>(most) - 1], 0) << "not half of it";
    other.put(0xFF, 1);
    EXPECT_EQ(other.frame().data[static_cast<std::size_t>(most) - 1], 0xFF);
  }
}

TEST(CanopenFields, SignedOnesKeepTheirSign) {
  const CanFrame frame = parse("185#FF7FFF7F00800080");
  const auto taken = [&](int skip, int bytes) {
    FieldReader reader(frame);
    static_cast<void>(reader.take(skip));
    return reader.take_signed(bytes);
  };
  EXPECT_EQ(taken(0, 1), -1);
  EXPECT_EQ(taken(1, 1), 127);
  EXPECT_EQ(taken(0, 2), 32767);
  EXPECT_EQ(taken(4, 2), -32768);
  EXPECT_EQ(taken(0, 4), 0x7FFF7FFF);
  EXPECT_EQ(taken(4, 4), static_cast<std::int32_t>(0x80008000));
}

TEST(CanopenFields, AFrameThatIsTooShortStaysSo) {
  const CanFrame frame = parse("185#010203");
  FieldReader reader(frame);
  EXPECT_EQ(reader.take(2), 0x0201u);
  EXPECT_EQ(reader.take(2), 0u);
  EXPECT_FALSE(reader.complete());
  EXPECT_EQ(reader.take(1), 0u) << "also what would fit";
  EXPECT_FALSE(reader.complete());
}

}  // namespace
}  // namespace limber::test_canopen_edges
