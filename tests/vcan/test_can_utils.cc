// The SocketCAN bus beside can-utils: what candump prints of our frames, what we make of cansend's,
// and whether canbusload counts the same bits.
#include <gtest/gtest.h>
#include <poll.h>

#include <array>
#include <cstdio>
#include <memory>
#include <random>
#include <regex>
#include <string>

#include "drivers/can/frame_time.h"
#include "drivers/protocols/mit.h"
#include "tests/vcan/lab.h"

namespace limber::test_can_utils {
namespace {

using testing::kSecond;
using testing::numbered;
using testing::receive;
using testing::run;

/// Another program's output, line by line.
class Program {
 public:
  explicit Program(const std::string& command) : pipe_(popen(command.c_str(), "r"), pclose) {
    setvbuf(pipe_.get(), nullptr, _IONBF, 0);  // poll() must see all that has not been read
  }
  /// The next line; empty if there is none within the time.
  std::string line(int timeout_ms) {
    pollfd polled{fileno(pipe_.get()), POLLIN, 0};
    std::array<char, 512> text{};
    if (poll(&polled, 1, timeout_ms) <= 0 ||
        std::fgets(text.data(), text.size(), pipe_.get()) == nullptr)
      return {};
    return text.data();
  }

 private:
  std::unique_ptr<FILE, int (*)(FILE*)> pipe_;
};

TEST(CanUtils, CandumpPrintsOurFrames) {
  const auto bus = open_can_bus("socketcan:vcan0", true);
  Program candump("candump -L -T 1000 vcan0");
  const CanFrame sentinel = numbered(0x7FE);
  std::string first;
  for (int i = 0; i < 100 && first.empty(); ++i) {
    bus->send(sentinel);
    first = candump.line(100);
  }
  ASSERT_NE(first.find("7FE#FEFF000102030405"), std::string::npos) << first;

  CanFrame command;
  ASSERT_TRUE(mit::encode_command({1.0, -2.0, 60.0, 1.5, 2.5}, {12.5, 30.0, 10.0, 500.0, 5.0}, 3,
                                  false, mit::Quantiser::kTruncate, &command));
  CanFrame extended = numbered(0x1FFFFFF0);
  extended.extended = true;
  CanFrame remote;
  remote.id = 0x123;
  remote.remote = true;
  CanFrame fd = command;
  fd.fd = fd.bitrate_switch = true;
  ASSERT_EQ(bus->send(std::array{command, extended, remote, fd,
                                 mit::encode_special(mit::Special::kEnable, 3, false)}),
            5);
  // The digit behind ## holds the frame's flags: bit rate switch, and from some kernels on a bit
  // that says "FD".
  for (const char* expected : {"003#8A3C7771EB4CC9FF", "1FFFFFF0#F0F1F2F3F4F5F6F7", "123#R",
                               "003##[15]8A3C7771EB4CC9FF", "003#FFFFFFFFFFFFFFFC"}) {
    std::string line = candump.line(2000);
    while (line.find("7FE#") != std::string::npos) line = candump.line(2000);
    EXPECT_TRUE(std::regex_search(line, std::regex(std::string(" ") + expected + "0?\\s*$")))
        << line << expected;
  }
}

TEST(CanUtils, WeReadCansendsFrames) {
  const auto bus = open_can_bus("socketcan:vcan0", true);
  run("cansend vcan0 013#1387AD7DD9702926");
  run("cansend vcan0 00000013#01");
  run("cansend vcan0 123#R4");
  run("cansend vcan0 004##1000102030405060708090A0B");
  run("cansend vcan0 20000040#0000000000000000");
  const auto got = receive(bus.get(), 5);
  ASSERT_EQ(got.size(), 5U);
  mit::Reply reply;
  ASSERT_TRUE(mit::decode_reply(got[0], {12.5, 30.0, 10.0, 500.0, 5.0}, &reply));
  EXPECT_NEAR(reply.position_rad, 0.7498, 5e-5);
  EXPECT_TRUE(got[1].extended);
  EXPECT_EQ(got[1].id, 0x13U);
  EXPECT_TRUE(got[2].remote);
  EXPECT_EQ(got[2].length, 4);
  EXPECT_TRUE(got[3].fd && got[3].bitrate_switch);
  EXPECT_EQ(got[3].length, 12);
  EXPECT_EQ(got[3].data[11], 0x0B);
  EXPECT_TRUE(got[4].error);
  EXPECT_TRUE(bus->statistics().bus_off);
}

TEST(CanUtils, CanbusloadCountsTheSameBits) {
  const auto bus = open_can_bus("socketcan:vcan1", true);
  Program canbusload("timeout 6 canbusload -e vcan1@1000000");
  std::mt19937 random(5);
  std::vector<CanFrame> frames(120);
  long bits = 0;
  for (CanFrame& frame : frames) {
    frame.extended = (random() & 1U) != 0;
    frame.id = random() & (frame.extended ? kExtendedIdMax : kStandardIdMax);
    frame.length = static_cast<std::uint8_t>(random() % 9);
    const std::uint32_t mask =
        (random() & 1U) != 0 ? 0xFFU : 0x18U;  // with long runs of equal bits, too
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random() & mask);
    bits += classic_frame_bits(frame);
  }
  // " vcan1@1000000   120  12345 ...": frames and bits of the last second. The first report says
  // that it listens.
  const std::regex report("vcan1@1000000 +([0-9]+) +([0-9]+)");
  bool sent = false;
  long frames_counted = 0;
  long bits_counted = 0;
  for (std::string line = canbusload.line(5000); !line.empty() && frames_counted < 120;
       line = canbusload.line(5000)) {
    std::smatch match;
    if (!std::regex_search(line, match, report)) continue;
    frames_counted += std::stol(match[1]);
    bits_counted += std::stol(match[2]);
    if (!sent) {
      EXPECT_EQ(bus->send(frames), 120);
    }
    sent = true;
  }
  EXPECT_EQ(frames_counted, 120);
  EXPECT_EQ(bits_counted, bits);
}

}  // namespace
}  // namespace limber::test_can_utils
