// Subframes of the moteus protocol, byte by byte: what fits, what is malformed, and the texts.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "drivers/protocols/moteus_frame.h"
#include "tests/support/frame_text.h"

namespace limber::test_moteus_subframes {
namespace {

using namespace moteus;
using Bytes = std::vector<int>;
using Kind = Subframe::Kind;

CanFrame frame_of(const Bytes& bytes) {
  CanFrame frame;
  frame.fd = true;
  frame.length = static_cast<std::uint8_t>(bytes.size());
  std::transform(bytes.begin(), bytes.end(), frame.data.begin(),
                 [](int byte) { return static_cast<std::uint8_t>(byte); });
  return frame;
}
Bytes bytes_of(const CanFrame& frame) {
  return {frame.data.begin(), frame.data.begin() + frame.length};
}

/// The first subframe, and how the frame goes on behind it.
struct Parsed {
  explicit Parsed(const Bytes& bytes) : frame(frame_of(bytes)), reader(frame) {
    ok = reader.next(&subframe);
    EXPECT_EQ(reader.malformed(), !ok);
  }
  bool next() { return reader.next(&subframe); }

  CanFrame frame;
  FrameReader reader;
  Subframe subframe;
  bool ok = false;
};
bool malformed(const Bytes& bytes) {
  Parsed parsed(bytes);
  if (!parsed.ok) {
    EXPECT_FALSE(parsed.next()) << "for good";
  }
  return !parsed.ok;
}

TEST(MoteusSubframes, Errors) {
  Parsed parsed({0x30, 0x21, 0xFF, 0x01, 0x31, 0xFF, 0xFF, 0x03, 0x02, 0x50});
  ASSERT_TRUE(parsed.ok);
  EXPECT_EQ(parsed.subframe.kind, Kind::kWriteError);
  EXPECT_EQ(parsed.subframe.first, 0x21);
  EXPECT_EQ(parsed.subframe.count, 1u);
  EXPECT_EQ(parsed.subframe.error, 0xFF);
  ASSERT_TRUE(parsed.next());
  EXPECT_EQ(parsed.subframe.kind, Kind::kReadError);
  EXPECT_EQ(parsed.subframe.first, 0xFFFF);
  EXPECT_EQ(parsed.subframe.count, 1u);
  EXPECT_EQ(parsed.subframe.error, 2);
  EXPECT_FALSE(parsed.next());
  EXPECT_FALSE(parsed.reader.malformed()) << "the end";
  for (const Bytes& bad : std::vector<Bytes>{{0x30},
                                             {0x31, 0x21},
                                             {0x30, 0x80},
                                             {0x30, 0x21, 0x80},
                                             {0x30, 0x21, 0x80, 0x02},           // error 100h
                                             {0x31, 0x80, 0x80, 0x04, 0x01}}) {  // register 10000h
    EXPECT_TRUE(malformed(bad)) << bad.size();
  }
}

TEST(MoteusSubframes, ReadsWritesAndReplies) {
  const std::tuple<Bytes, Kind, Type, unsigned> cases[] = {
      {{0x11, 0x05}, Kind::kRead, Type::kInt8, 1},
      {{0x1F, 0x05}, Kind::kRead, Type::kFloat, 3},
      {{0x14, 0x09, 0x05}, Kind::kRead, Type::kInt16, 9},
      {{0x10, 0x00, 0x05}, Kind::kRead, Type::kInt8, 0},
      {{0x01, 0x05, 0xAA}, Kind::kWrite, Type::kInt8, 1},
      {{0x0F, 0x05, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, Kind::kWrite, Type::kFloat, 3},
      {{0x20, 0x02, 0x05, 0xAA, 0xBB}, Kind::kReply, Type::kInt8, 2},
      {{0x2F, 0x05, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, Kind::kReply, Type::kFloat, 3},
  };
  for (auto [bytes, kind, type, count] : cases) {
    const std::size_t size = bytes.size();
    for (const int last : {0x11, 0x06}) bytes.push_back(last);
    Parsed parsed(bytes);
    ASSERT_TRUE(parsed.ok) << bytes[0];
    EXPECT_EQ(parsed.subframe.kind, kind) << bytes[0];
    EXPECT_EQ(parsed.subframe.type, type) << bytes[0];
    EXPECT_EQ(parsed.subframe.first, 5) << bytes[0];
    EXPECT_EQ(parsed.subframe.count, count) << bytes[0];
    ASSERT_TRUE(parsed.next()) << "what follows is taken from where it begins";
    EXPECT_EQ(parsed.subframe.first, 6);
    if (kind != Kind::kRead) {
      EXPECT_TRUE(malformed({bytes.begin(), bytes.begin() + static_cast<int>(size) - 1}));
    }
  }
}

// Registers count in 16 bits; the last one that is read is FFFEh.
TEST(MoteusSubframes, RegistersThatDoNotExist) {
  EXPECT_FALSE(malformed({0x11, 0xFE, 0xFF, 0x03}));
  EXPECT_FALSE(malformed({0x10, 0x00, 0xFF, 0xFF, 0x03}));
  EXPECT_FALSE(malformed({0x10, 0xFF, 0xFF, 0x03, 0x00})) << "FFFFh from 0 on";
  EXPECT_TRUE(malformed({0x11, 0xFF, 0xFF, 0x03}));
  EXPECT_TRUE(malformed({0x12, 0xFE, 0xFF, 0x03}));
  EXPECT_TRUE(malformed({0x10, 0x00, 0x80, 0x80, 0x04})) << "10000h";
  EXPECT_TRUE(malformed({0x10, 0x80, 0x80, 0x04, 0x00}));
}

TEST(MoteusSubframes, NumbersOfFourTimesSevenBits) {
  Parsed parsed({0x10, 0x85, 0x80, 0x80, 0x00, 0x05});
  ASSERT_TRUE(parsed.ok);
  EXPECT_EQ(parsed.subframe.count, 5u);
  EXPECT_TRUE(malformed({0x10, 0x85, 0x80, 0x80, 0x80, 0x00, 0x05}));
  EXPECT_TRUE(malformed({0x10, 0x85})) << "more follows, but does not";
  EXPECT_EQ(Parsed({0x11, 0x7F}).subframe.first, 0x7F);
  EXPECT_EQ(Parsed({0x11, 0x80, 0x01}).subframe.first, 0x80);
}

TEST(MoteusSubframes, OtherOpcodesAreMalformed) {
  for (int opcode = 0x32; opcode <= 0xFF; ++opcode) {
    const bool known = (opcode >= 0x40 && opcode <= 0x42) || opcode == 0x50;
    if (!known) {
      EXPECT_TRUE(malformed({opcode, 0x01, 0x00, 0x00})) << opcode;
    }
  }
}

TEST(MoteusSubframes, Text) {
  Parsed parsed(
      {0x40, 0x01, 0x02, 'h', 'i', 0x41, 0xFF, 0xFF, 0x03, 0x00, 0x42, 0x02, 0x3D, 0x11, 0x05});
  ASSERT_TRUE(parsed.ok);
  EXPECT_EQ(parsed.subframe.kind, Kind::kTextToDrive);
  EXPECT_EQ(parsed.subframe.first, 1);
  EXPECT_EQ(parsed.subframe.text(), "hi");
  ASSERT_TRUE(parsed.next());
  EXPECT_EQ(parsed.subframe.kind, Kind::kTextFromDrive);
  EXPECT_EQ(parsed.subframe.first, 0xFFFF);
  EXPECT_EQ(parsed.subframe.text(), "");
  ASSERT_TRUE(parsed.next());
  EXPECT_EQ(parsed.subframe.kind, Kind::kTextPoll);
  EXPECT_EQ(parsed.subframe.first, 2);
  EXPECT_EQ(parsed.subframe.count, 61u);
  EXPECT_EQ(parsed.subframe.text(), "") << "a poll has none";
  ASSERT_TRUE(parsed.next());
  EXPECT_EQ(parsed.subframe.kind, Kind::kRead);
  EXPECT_EQ(Subframe{}.text(), "");
  for (const Bytes& bad : std::vector<Bytes>{{0x41},
                                             {0x41, 0x01},
                                             {0x42, 0x01},
                                             {0x41, 0x80},
                                             {0x41, 0x01, 0x02, 'h'},
                                             {0x42, 0x80, 0x80, 0x04, 0x01}}) {
    EXPECT_TRUE(malformed(bad)) << bad.size();
  }
}

// --- writing
// --------------------------------------------------------------------------------------

TEST(MoteusFrames, LongIdentifiersHave29Bits) {
  EXPECT_FALSE(FrameWriter(0x7FF).frame().extended);
  EXPECT_TRUE(FrameWriter(0x800).frame().extended);
}

/// What a writer makes, without padding.
template <typename Write>
Bytes written(Write write) {
  FrameWriter writer(1);
  EXPECT_TRUE(write(writer));
  Bytes bytes = bytes_of(writer.frame());
  while (!bytes.empty() && bytes.back() == 0x50) bytes.pop_back();
  return bytes;
}

TEST(MoteusFrames, NumbersAndOpcodes) {
  const auto read = [](unsigned first, unsigned count) {
    return written([=](FrameWriter& writer) {
      return writer.read(Type::kInt32, static_cast<std::uint16_t>(first), count);
    });
  };
  EXPECT_EQ(read(5, 1), Bytes({0x19, 0x05}));
  EXPECT_EQ(read(5, 3), Bytes({0x1B, 0x05}));
  EXPECT_EQ(read(5, 4), Bytes({0x18, 0x04, 0x05}));
  EXPECT_EQ(read(5, 0), Bytes({0x18, 0x00, 0x05}));
  EXPECT_EQ(read(0x7F, 1), Bytes({0x19, 0x7F}));
  EXPECT_EQ(read(0x80, 1), Bytes({0x19, 0x80, 0x01}));
  EXPECT_EQ(read(0x3FFF, 1), Bytes({0x19, 0xFF, 0x7F}));
  EXPECT_EQ(written([](FrameWriter& w) { return w.write_error(0x102, 2); }),
            Bytes({0x30, 0x82, 0x02, 0x02}));
  EXPECT_EQ(written([](FrameWriter& w) { return w.read_error(0x12, 1); }),
            Bytes({0x31, 0x12, 0x01}));
  EXPECT_EQ(written([](FrameWriter& w) { return w.text_to_drive("a"); }),
            Bytes({0x40, 0x01, 0x01, 'a'}));
  EXPECT_EQ(written([](FrameWriter& w) { return w.text_from_drive("b"); }),
            Bytes({0x41, 0x01, 0x01, 'b'}));
  EXPECT_EQ(written([](FrameWriter& w) { return w.text_poll(61); }), Bytes({0x42, 0x01, 0x3D}));
}

// Into a frame that has room for some of it, nothing of a subframe is written.
TEST(MoteusFrames, ASubframeIsThereWholeOrNotAtAll) {
  const double values[] = {1.0, 2.0};
  const std::pair<std::size_t, std::function<bool(FrameWriter&)>> writes[] = {
      {5,
       [&](FrameWriter& w) {
         return w.write(Type::kInt16, Register::kModel, {values, 1});
       }},
      {4, [&](FrameWriter& w) { return w.reply(Type::kInt8, 5, values); }},
      {4, [](FrameWriter& w) { return w.read(Type::kInt8, 0x100, 9); }},
      {4, [](FrameWriter& w) { return w.write_error(0x100, 1); }},
      {4, [](FrameWriter& w) { return w.read_error(0x100, 1); }},
      {5, [](FrameWriter& w) { return w.text_to_drive("hi"); }},
      {3, [](FrameWriter& w) { return w.text_poll(61); }},
      {4, [](FrameWriter& w) { return w.text_poll(128); }},
  };
  for (std::size_t filled = 56; filled <= 64; ++filled) {
    for (const auto& [size, write] : writes) {
      FrameWriter writer(1);
      ASSERT_TRUE(writer.text_to_drive(std::string(filled - 3, 'x')));
      const Bytes before = bytes_of(writer.frame());
      const bool fits = write(writer);
      EXPECT_EQ(fits, filled + size <= 64) << filled << " and " << size;
      if (!fits) {
        EXPECT_EQ(bytes_of(writer.frame()), before) << filled << " and " << size;
      }
    }
  }
}

TEST(MoteusFrames, RoomForText) {
  EXPECT_EQ(FrameWriter(1).room_for_text(), 61u);
  for (std::size_t filled = 58; filled <= 64; ++filled) {
    FrameWriter writer(1);
    ASSERT_TRUE(writer.text_to_drive(std::string(filled - 3, 'x')));
    EXPECT_EQ(writer.room_for_text(), filled < 61 ? 61 - filled : 0) << filled;
  }
}

TEST(MoteusFrames, NobodysAddressIsTheHosts) {
  EXPECT_EQ(can_id(Address{}), 0u);
  EXPECT_EQ(Subframe{}.first, 0);
  EXPECT_EQ(Subframe{}.error, 0);
}

TEST(MoteusTexts, ModesAndFaults) {
  EXPECT_STREQ(mode_text(0), "stopped");
  EXPECT_STREQ(mode_text(10), "position");
  EXPECT_STREQ(mode_text(15), "brake");
  for (const int unknown : {-1, 14, 16, 255}) EXPECT_STREQ(mode_text(unknown), "") << unknown;
  EXPECT_STREQ(fault_text(0), "none");
  EXPECT_STREQ(fault_text(32), "calibration");
  EXPECT_STREQ(fault_text(33), "motor driver");
  EXPECT_STREQ(fault_text(50), "velocity error");
  for (const int unknown : {-1, 1, 31, 51, 255}) EXPECT_STREQ(fault_text(unknown), "") << unknown;
}

}  // namespace
}  // namespace limber::test_moteus_subframes
