// A plane in LCM's wire format: what LCM's own library sends and hears, what is passed over, what
// waits while the process is busy.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <lcm/lcm-cpp.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <limber/mode_request_t.hpp>
#include <limber/push_t.hpp>
#include <string>
#include <vector>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/lcm_port.h"
#include "common/lcm_url.h"
#include "common/multicast_socket.h"
#include "common/receive_buffer.h"
#include "tests/drivers/can/private_network.h"
#include "tools/allocations/allocations.h"

namespace limber::test_lcm_port {
namespace {

const bool kPrivateNetwork = testing::enter_private_network();
const std::string kUrl = "udpm://239.255.76.99:7699?ttl=0";
constexpr std::int64_t kSecond = 1'000'000'000;

class LcmPortTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!kPrivateNetwork) GTEST_SKIP() << "needs a network of its own";
  }
  static mode_request_t request(std::int64_t seq) {
    mode_request_t message{};
    message.seq = seq;
    return message;
  }
  /// Until nothing more comes for a while.
  void handle_all(LcmPort& port) {
    while (wait_readable(port.descriptor(), monotonic_ns() + kSecond / 20)) port.handle_waiting();
    port.handle_waiting();
  }
  void subscribe(LcmPort& port, int queue = 32) {
    port.subscribe<mode_request_t>("MODE_REQUEST", queue,
                                   [this](const mode_request_t& m) { heard.push_back(m.seq); });
  }
  std::vector<std::int64_t> heard;
};

// A receiver is joined before its program reads: what comes at once then is kept, from the first
// message on. The kernel's own buffer has room for 256 of these.
TEST_F(LcmPortTest, KeepsWhatComesWhileItsProgramIsBusy) {
  constexpr int kMessages = 1000;
  const sockaddr_in group = parse_lcm_url(kUrl).group;
  const MulticastSockets sockets = open_multicast("busy", group, 0, kReceiveBuffer_bytes);
  const FileDescriptor alone = open_multicast_receiver("busy", group, kReceiveBuffer_bytes);
  LcmPort port(kUrl);
  subscribe(port, 2 * kMessages);
  lcm::LCM lcm(kUrl);
  for (std::int64_t seq = 0; seq < kMessages; ++seq) {
    const mode_request_t message = request(seq);
    lcm.publish("MODE_REQUEST", &message);
  }
  for (const int socket : {sockets.receiver.get(), alone.get()}) {
    int waiting = 0;
    for (char byte = 0; recv(socket, &byte, 1, MSG_DONTWAIT) >= 0;) ++waiting;
    EXPECT_EQ(waiting, kMessages);
  }
  handle_all(port);
  EXPECT_EQ(heard.size(), std::size_t{kMessages});
}

TEST_F(LcmPortTest, HearsWhatLcmSends) {
  LcmPort port(kUrl);
  subscribe(port);
  lcm::LCM lcm(kUrl);
  for (std::int64_t seq = 1; seq <= 3; ++seq) {
    const mode_request_t message = request(seq);
    lcm.publish("MODE_REQUEST", &message);
  }
  handle_all(port);
  EXPECT_EQ(heard, (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_EQ(port.undecodable(), 0);
}

TEST_F(LcmPortTest, LcmHearsWhatItSends) {
  lcm::LCM lcm(kUrl);
  struct Listener {
    void take(const lcm::ReceiveBuffer*, const std::string& channel, const mode_request_t* m) {
      text += channel + " " + std::to_string(m->seq) + ";";
    }
    std::string text;
  } listener;
  lcm.subscribe("MODE_.*", &Listener::take, &listener);
  LcmPort port(kUrl, LcmPort::Use::kPublishOnly);
  EXPECT_EQ(port.descriptor(), -1);
  EXPECT_TRUE(port.publish("MODE_REQUEST", request(7)));
  EXPECT_TRUE(port.publish("MODE_REQUEST", request(8)));
  for (int i = 0; i < 2; ++i) lcm.handleTimeout(1000);
  EXPECT_EQ(listener.text, "MODE_REQUEST 7;MODE_REQUEST 8;");
}

/// Not even the kernel wakes this process for them.
TEST_F(LcmPortTest, OtherChannelsAndItsOwnMessagesDoNotWakeIt) {
  LcmPort port(kUrl);
  subscribe(port);
  LcmPort other(kUrl, LcmPort::Use::kPublishOnly);
  other.publish("JOINT_STATE", joint_state_t{});
  other.publish("MODE_REQUES", request(1));
  other.publish("MODE_REQUEST2", request(1));
  other.publish("", request(1));
  port.publish("MODE_REQUEST", request(1));
  EXPECT_FALSE(wait_readable(port.descriptor(), monotonic_ns() + kSecond / 20));
  other.publish("MODE_REQUEST", request(2));
  handle_all(port);
  EXPECT_EQ(heard, std::vector<std::int64_t>{2});
}

TEST_F(LcmPortTest, ChannelsComeInTheOrderTheyWereSent) {
  LcmPort port(kUrl);
  subscribe(port);
  port.subscribe<push_t>("PUSH", 4, [this](const push_t& push) { heard.push_back(-push.id); });
  LcmPort other(kUrl, LcmPort::Use::kPublishOnly);
  push_t push{};
  for (std::int64_t seq = 1; seq <= 2; ++seq) {
    other.publish("MODE_REQUEST", request(seq));
    push.id = static_cast<std::int16_t>(seq);
    other.publish("PUSH", push);
  }
  handle_all(port);
  EXPECT_EQ(heard, (std::vector<std::int64_t>{1, -1, 2, -2}));
}

TEST_F(LcmPortTest, AFullQueueKeepsTheOldestAndLeavesOtherChannelsAlone) {
  LcmPort port(kUrl);
  subscribe(port, 3);
  port.subscribe<push_t>("PUSH", 1, [this](const push_t& push) { heard.push_back(-push.id); });
  LcmPort other(kUrl, LcmPort::Use::kPublishOnly);
  for (std::int64_t seq = 1; seq <= 10; ++seq) other.publish("MODE_REQUEST", request(seq));
  push_t push{};
  push.id = 5;
  other.publish("PUSH", push);
  ASSERT_TRUE(wait_readable(port.descriptor(), monotonic_ns() + kSecond));
  port.handle_waiting(2);
  EXPECT_EQ(heard, (std::vector<std::int64_t>{1, 2}));
  other.publish("MODE_REQUEST", request(11));
  handle_all(port);
  EXPECT_EQ(heard, (std::vector<std::int64_t>{1, 2, 3, -5, 11}));
}

TEST_F(LcmPortTest, WhatIsNoMessageIsCounted) {
  LcmPort port(kUrl);
  subscribe(port);
  lcm::LCM lcm(kUrl);
  const std::vector<char> bytes(5000, 'x');
  for (const unsigned size : {0U, 1U, 100U, 1400U, 1401U, 1500U, 5000U})
    lcm.publish("MODE_REQUEST", bytes.data(), size);
  LcmPort(kUrl, LcmPort::Use::kPublishOnly).publish("MODE_REQUEST", joint_command_t{});
  handle_all(port);
  EXPECT_TRUE(heard.empty());
  EXPECT_EQ(port.undecodable(), 8);
}

TEST_F(LcmPortTest, NothingIsAllocatedForAMessage) {
  LcmPort port(kUrl);
  LcmPort other(kUrl, LcmPort::Use::kPublishOnly);
  std::int64_t seen = 0;
  port.subscribe<mode_request_t>("MODE_REQUEST", 4, [&](const mode_request_t& m) { seen = m.seq; });
  const std::int64_t before = allocations();
  const bool sent = other.publish("MODE_REQUEST", request(9));
  const bool arrived = wait_readable(port.descriptor(), monotonic_ns() + kSecond);
  port.handle_waiting();
  EXPECT_EQ(allocations(), before);
  EXPECT_TRUE(sent && arrived);
  EXPECT_EQ(seen, 9);
}

TEST_F(LcmPortTest, AWrongAddressIsRefused) {
  EXPECT_THROW(LcmPort("udpm://127.0.0.1:7667"), ConfigError);
  EXPECT_THROW(LcmPort("shm:arm"), ConfigError);
}

}  // namespace
}  // namespace limber::test_lcm_port
