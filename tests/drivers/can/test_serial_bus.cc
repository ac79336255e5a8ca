// Serial adapters on pseudo-terminals, with what true ones do: partial frames, lost bytes,
// refusals, a line that blocks, one that is unplugged and comes back.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <string>
#include <thread>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/file_descriptor.h"
#include "drivers/can/can_bus.h"
#include "tools/allocations/allocations.h"

namespace limber::test_serial_bus {
namespace {

using namespace std::chrono_literals;

/// The adapter's end of a line.
class Adapter {
 public:
  Adapter() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    EXPECT_EQ(grantpt(master_.get()), 0);
    EXPECT_EQ(unlockpt(master_.get()), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(ptsname_r(master_.get(), name.data(), name.size()), 0);
    device_ = name.data();
  }

  const std::string& device() const { return device_; }

  void write(const std::string& bytes) const {
    EXPECT_EQ(::write(master_.get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }

  /// What comes within a moment.
  std::string read(int most = 4096) const {
    std::string text;
    pollfd waiting{master_.get(), POLLIN, 0};
    while (static_cast<int>(text.size()) < most && poll(&waiting, 1, 20) > 0) {
      std::array<char, 4096> buffer{};
      const ssize_t bytes = ::read(master_.get(), buffer.data(),
                                   std::min<std::size_t>(buffer.size(), most - text.size()));
      if (bytes <= 0) break;
      text.append(buffer.data(), static_cast<std::size_t>(bytes));
    }
    return text;
  }

  void unplug() { master_ = FileDescriptor(); }

 private:
  FileDescriptor master_;
  std::string device_;
};

/// Opens the bus while the adapter answers each of its lines.
std::unique_ptr<CanBus> opened(const Adapter& adapter, const std::string& answers, int bitrate,
                               std::string* heard) {
  auto bus = std::async(std::launch::async, [&] {
    return open_can_bus("slcan:" + adapter.device(), false, Stamps::kOnArrival, bitrate);
  });
  std::size_t next = 0;
  while (bus.wait_for(0s) != std::future_status::ready) {
    const std::string line = adapter.read(64);
    *heard += line;
    if (!line.empty() && next < answers.size()) adapter.write(std::string(1, answers[next++]));
  }
  *heard += adapter.read();
  return bus.get();
}

std::unique_ptr<CanBus> opened(const Adapter& adapter) {
  std::string heard;
  return opened(adapter, "\a\r\r", 1'000'000, &heard);
}

CanFrame frame_of(std::uint32_t id) {
  CanFrame frame;
  frame.id = id;
  frame.length = 8;
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(i);
  return frame;
}

std::vector<CanFrame> received(CanBus* bus) {
  CanBus* const buses[] = {bus};
  wait_readable(buses, monotonic_ns() + 200'000'000);
  std::vector<CanFrame> frames(16);
  frames.resize(static_cast<std::size_t>(bus->receive(frames)));
  return frames;
}

TEST(SerialBus, OpensAtTheBitRateAndCloses) {
  const Adapter adapter;
  std::string heard;
  auto bus = opened(adapter, "\a\r\r", 500'000, &heard);  // it was closed: that is no refusal
  EXPECT_EQ(heard, "\r\rC\rS6\rO\r");
  bus.reset();
  EXPECT_EQ(adapter.read(), "C\r");
}

TEST(SerialBus, AnAdapterThatAnswersNothingWillDo) {
  const Adapter adapter;
  std::string heard;
  EXPECT_NE(opened(adapter, "", 1'000'000, &heard), nullptr);
}

TEST(SerialBus, ARefusalNamesWhatIsRefused) {
  for (const auto& [answers, words] : {std::pair{"\r\a\r", "refuses a bit rate of 250000 bit/s"},
                                       std::pair{"\r\r\a", "refuses its CAN side to open"}}) {
    const Adapter adapter;
    std::string heard;
    try {
      opened(adapter, answers, 250'000, &heard);
      ADD_FAILURE() << words;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(adapter.device()), std::string::npos);
    }
  }
}

TEST(SerialBus, WhatCannotBeOpenedIsToldWithTheCure) {
  const auto refusal = [](const std::string& address, bool fd = false) -> std::string {
    try {
      open_can_bus(address, fd);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "opened";
  };
  EXPECT_NE(refusal("slcan:/dev/nosuch").find("ls /dev/serial/by-id"), std::string::npos);
  EXPECT_NE(refusal("dmserial:/dev/null").find("no serial line"), std::string::npos);
  EXPECT_NE(refusal("slcan:/dev/null@1234").find("no usual rate"), std::string::npos);
  EXPECT_NE(refusal("slcan:ttyACM0").find("slcan:/dev/NAME"), std::string::npos);
  EXPECT_NE(refusal("slcan:/dev/ttyACM0@fast").find("@BAUD"), std::string::npos);
  EXPECT_NE(refusal("slcan:/dev/null", true).find("no CAN-FD"), std::string::npos);
}

TEST(SerialBus, FramesGoOutAndIn) {
  const Adapter adapter;
  const auto bus = opened(adapter);
  const std::array<CanFrame, 2> frames = {frame_of(1), frame_of(2)};
  EXPECT_EQ(bus->send(frames), 2);
  EXPECT_EQ(adapter.read(), "t00180001020304050607\rt00280001020304050607\r");
  adapter.write("t0112AB");  // the rest comes later
  EXPECT_TRUE(received(bus.get()).empty());
  adapter.write("CD\rt01200\rt0130\r");  // the second is damaged
  const std::vector<CanFrame> taken = received(bus.get());
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken[0].id, 0x11U);
  EXPECT_EQ(taken[0].data[1], 0xCD);
  EXPECT_GT(taken[0].timestamp_ns, 0);
  EXPECT_EQ(taken[1].id, 0x13U);
  EXPECT_EQ(bus->statistics().sent, 2);
  EXPECT_EQ(bus->statistics().received, 2);
  EXPECT_EQ(bus->statistics().malformed, 1);
}

TEST(SerialBus, WhatTheAdapterDoesNotSendIsCounted) {
  const Adapter adapter;
  const auto bus = opened(adapter);
  bus->send(frame_of(1));
  adapter.write("\a");
  EXPECT_TRUE(received(bus.get()).empty());
  EXPECT_EQ(bus->statistics().send_refused, 1);
  CanFrame fd = frame_of(1);
  fd.fd = true;
  EXPECT_EQ(bus->send(fd), 0);
  EXPECT_EQ(bus->statistics().send_refused, 2);
}

TEST(SerialBus, OneFrameAtATimeIsEnoughForAReader) {
  const Adapter adapter;
  const auto bus = opened(adapter);
  adapter.write("t0010\rt0020\rt0030\r");
  CanBus* const buses[] = {bus.get()};
  for (std::uint32_t id = 1; id <= 3; ++id) {
    ASSERT_TRUE(wait_readable(buses, monotonic_ns() + 200'000'000)) << id;
    CanFrame frame;
    ASSERT_EQ(bus->receive(std::span(&frame, 1)), 1);
    EXPECT_EQ(frame.id, id);
  }
}

// The adapter reads nothing: the line fills, in the midst of a frame. No frame may be cut in two
// by the next, nor one that was refused be sent later.
TEST(SerialBus, ALineThatBlocksCutsNoFrame) {
  const Adapter adapter;
  const auto bus = opened(adapter);
  int accepted = 0;
  int refused = 0;
  while (refused < 3 && accepted < 100'000) {
    if (bus->send(frame_of(static_cast<std::uint32_t>(accepted % 0x700))) == 1) {
      ++accepted;
    } else {
      ++refused;
    }
  }
  ASSERT_EQ(refused, 3) << "the line never filled";
  EXPECT_TRUE(bus->statistics().unsent);
  EXPECT_EQ(bus->statistics().send_refused, 3);
  std::string text = adapter.read(1 << 24);
  EXPECT_EQ(bus->send(frame_of(0x7FF)), 1);
  text += adapter.read();
  const std::size_t line = std::string("t00080001020304050607\r").size();
  ASSERT_EQ(text.size(), line * static_cast<std::size_t>(accepted + 1));
  for (int i = 0; i <= accepted; ++i) {
    const std::string one = text.substr(line * static_cast<std::size_t>(i), line);
    ASSERT_EQ(one.front(), 't') << i;
    const int id = i == accepted ? 0x7FF : i % 0x700;
    ASSERT_EQ(std::stoi(one.substr(1, 3), nullptr, 16), id) << i;
  }
}

TEST(SerialBus, AnAdapterThatWasUnpluggedComesBack) {
  const std::string link = testing::TempDir() + "limber_adapter_" + std::to_string(getpid());
  Adapter adapter;
  std::filesystem::create_symlink(adapter.device(), link);
  const auto bus = open_can_bus("dmserial:" + link, false);
  EXPECT_EQ(bus->send(frame_of(1)), 1);
  adapter.unplug();
  std::filesystem::remove(link);
  std::array<CanFrame, 4> frames;
  EXPECT_EQ(bus->receive(frames), 0);
  EXPECT_TRUE(bus->statistics().link_down);
  EXPECT_EQ(bus->descriptor(), -1);
  EXPECT_EQ(bus->send(frame_of(1)), 0);
  const Adapter again;
  std::filesystem::create_symlink(again.device(), link);
  while (bus->send(frame_of(2)) == 0) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(bus->statistics().link_down);
  EXPECT_EQ(again.read().size(), 30U);
  std::filesystem::remove(link);
}

TEST(SerialBus, NothingIsAllocatedAfterOpening) {
  const Adapter adapter;
  const auto bus = opened(adapter);
  adapter.write("t0010\r\az\rt00\r");
  std::array<CanFrame, 4> frames;
  const std::array<CanFrame, 2> sent = {frame_of(1), frame_of(2)};
  std::this_thread::sleep_for(20ms);
  const auto before = allocations();
  bus->send(sent);
  bus->receive(frames);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace limber::test_serial_bus
