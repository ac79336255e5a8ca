// The wire's times and decisions against hand-computed ones.
#include <gtest/gtest.h>

#include <vector>

#include "sim/wire/wire.h"

namespace limber::sim::test_wire {
namespace {

// A classic frame without data and identifier 0x555, which needs no stuff bits before its control
// field: 47 bits with the inter-frame space, and two stuff bits for the zeros of control field and
// CRC. At 1 Mbit/s a bit is a microsecond.
constexpr std::int64_t kBit_ns = 1000;
constexpr int kDriver = 0;
constexpr int kNode = 1;
constexpr int kOther = 2;

BusConfig classic() { return {"arm", "virtual:test", false, 1'000'000, 1'000'000}; }

CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> data = {}) {
  CanFrame out;
  out.id = id;
  out.extended = id > kStandardIdMax;
  out.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), out.data.begin());
  return out;
}

std::vector<WireEvent> events(Wire* wire, std::int64_t until_ns) {
  std::vector<WireEvent> all;
  WireEvent event;
  while (wire->next(until_ns, &event)) all.push_back(event);
  return all;
}

// Eight bytes 0xAA: 47 + 64 bits; the only runs of five are the reserved bit, IDE and RTR with the
// zeros beside them.
TEST(Wire, AFrameTakesItsBits) {
  Wire wire(classic(), {.on = true}, 2, 0);
  wire.send(kDriver, frame(0x555, std::vector<std::uint8_t>(8, 0xAA)), 5'000);
  EXPECT_TRUE(events(&wire, 5'000 + 110 * kBit_ns).empty()) << "not before its last bit";
  const auto all = events(&wire, 5'000 + 115 * kBit_ns);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_GE(all[0].end_ns, 5'000 + 111 * kBit_ns);
  EXPECT_LE(all[0].end_ns, 5'000 + 115 * kBit_ns) << "at most four stuff bits";
  EXPECT_EQ(all[0].sender, kDriver);
  EXPECT_NEAR(wire.count().busy_s, static_cast<double>(all[0].end_ns - 5'000) * 1e-9, 1e-12);
}

TEST(Wire, TheLowerIdentifierWins) {
  Wire wire(classic(), {.on = true}, 3, 0);
  wire.send(kNode, frame(0x300), 0);
  wire.send(kOther, frame(0x100), 0);
  wire.send(kDriver, frame(0x200), 10 * kBit_ns);  // while the first one is on the wire
  const auto all = events(&wire, 1'000'000);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].frame.id, 0x100U);
  EXPECT_EQ(all[1].frame.id, 0x200U) << "ready later, but in time for the next arbitration";
  EXPECT_EQ(all[2].frame.id, 0x300U);
  EXPECT_GT(all[1].end_ns, all[0].end_ns + 46 * kBit_ns);
}

TEST(Wire, AStandardFrameWinsOverAnExtendedOneWithItsBits) {
  Wire wire(classic(), {.on = true}, 3, 0);
  wire.send(kNode, frame(0x123U << 18U | 1U), 0);
  wire.send(kOther, frame(0x123), 0);
  EXPECT_FALSE(events(&wire, 1'000'000)[0].frame.extended);
}

TEST(Wire, AnEndSendsInOrderWhateverTheIdentifiers) {
  Wire wire(classic(), {.on = true}, 2, 0);
  wire.send(kDriver, frame(0x400), 0);
  wire.send(kDriver, frame(0x001), 0);
  const auto all = events(&wire, 1'000'000);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].frame.id, 0x400U);
}

TEST(Wire, EqualFramesAtTheSameTimeAreOne) {
  Wire wire(classic(), {.on = true}, 3, 0);
  wire.send(kNode, frame(0x11, {1, 2}), 0);
  wire.send(kOther, frame(0x11, {1, 2}), 0);
  EXPECT_EQ(events(&wire, 1'000'000).size(), 1U);
  EXPECT_EQ(wire.count().errors, 0);
}

// Transmit error counters rise by 8 with each try: the 32nd makes 256 and both are bus-off.
TEST(Wire, TwoSendersOfOneIdentifierDestroyEachOther) {
  Wire wire(classic(), {.on = true}, 3, 0);
  wire.send(kNode, frame(0x11, {1, 2}), 0);
  wire.send(kOther, frame(0x11, {1, 3}), 0);
  const auto all = events(&wire, 3'000'000);
  ASSERT_EQ(all.size(), 32U);
  for (std::size_t i = 0; i < 31; ++i) EXPECT_EQ(all[i].kind, WireEvent::Kind::kError);
  EXPECT_EQ(all.back().kind, WireEvent::Kind::kBusOff);
  EXPECT_EQ(wire.count().errors, 64);
  EXPECT_EQ(wire.count().frames, 0);
}

TEST(Wire, BusOffEndsAfter128Times11Bits) {
  Wire wire(classic(), {.on = true, .corruption = 1.0}, 2, 0);
  wire.send(kDriver, frame(0x123), 0);
  auto all = events(&wire, 3'000'000);
  ASSERT_FALSE(all.empty());
  const WireEvent off = all.back();
  ASSERT_EQ(off.kind, WireEvent::Kind::kBusOff);
  EXPECT_EQ(all.size(), 32U);
  wire.send(kDriver, frame(0x123), off.end_ns + 1);
  EXPECT_EQ(wire.count().dropped, 2) << "the frame that failed, and the one sent while off";
  all = events(&wire, off.end_ns + 1407 * kBit_ns);
  EXPECT_TRUE(all.empty());
  all = events(&wire, off.end_ns + 1408 * kBit_ns);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].kind, WireEvent::Kind::kRestarted);
  EXPECT_EQ(wire.transmit_errors(kDriver), 0);
}

// ISO 11898-1: an error-passive sender waits eight bits more after a frame of its own, so that
// others come first. 16 destroyed frames count 128.
TEST(Wire, AnErrorPassiveSenderWaitsEightBitsAfterItsFrame) {
  const auto second_after_first_ns = [](int destroyed) {
    Wire wire(classic(), {.on = true}, 3, 0);
    wire.send(kNode, frame(0x555, {1}), 0);
    wire.send(kNode, frame(0x555, {1}), 0);
    wire.send(kOther, frame(0x555, {2}), 0);
    WireEvent event;
    for (int i = 0; i < destroyed; ++i) EXPECT_TRUE(wire.next(INT64_MAX, &event));
    CanFrame taken;
    EXPECT_TRUE(wire.take(kOther, &taken));
    const auto all = events(&wire, INT64_MAX);
    EXPECT_EQ(all.size(), 2U);
    return all.size() == 2 ? all[1].end_ns - all[0].end_ns : 0;
  };
  EXPECT_EQ(second_after_first_ns(18), second_after_first_ns(2) + 8 * kBit_ns);
}

TEST(Wire, ACorruptedFrameIsSentAgainAndCostsTime) {
  Wire ideal(classic(), {.on = true}, 2, 0);
  Wire noisy(classic(), {.on = true, .corruption = 0.3, .seed = 7}, 2, 0);
  for (int i = 0; i < 40; ++i) {
    for (Wire* wire : {&ideal, &noisy}) wire->send(kDriver, frame(0x123, {1, 2, 3, 4}), 0);
  }
  int frames = 0;
  for (const WireEvent& event : events(&noisy, 100'000'000))
    frames += event.kind == WireEvent::Kind::kFrame ? 1 : 0;
  events(&ideal, 100'000'000);
  EXPECT_EQ(frames, 40) << "none is lost";
  EXPECT_GT(noisy.count().errors, 4);
  EXPECT_GT(noisy.count().busy_s, ideal.count().busy_s);
}

TEST(Wire, LossIsSeededAndNoticedByNobody) {
  const auto lost = [](std::uint64_t seed) {
    Wire wire(classic(), {.on = true, .loss = 0.1, .seed = seed}, 2, 0);
    std::vector<int> out;
    for (int i = 0; i < 300; ++i) {
      wire.send(kNode, frame(0x11), i * 200 * kBit_ns);
      for (const WireEvent& event : events(&wire, (i + 1) * 200 * kBit_ns)) {
        if (event.kind == WireEvent::Kind::kLost) out.push_back(i);
      }
    }
    return out;
  };
  EXPECT_EQ(lost(1), lost(1));
  EXPECT_NE(lost(1), lost(2));
  EXPECT_NEAR(static_cast<double>(lost(1).size()), 30.0, 3.0 * 5.2);  // three standard deviations
}

}  // namespace
}  // namespace limber::sim::test_wire
