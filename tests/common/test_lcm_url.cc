// Which LCM addresses are taken: nothing that leaves this machine unless it is wanted.
#include <arpa/inet.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <optional>
#include <string>

#include "common/config_error.h"
#include "common/lcm_url.h"

namespace limber::test_lcm_url {
namespace {

std::string refusal(const std::string& url) {
  try {
    parse_lcm_url(url);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::string place(const std::string& url) {
  const LcmAddress address = parse_lcm_url(url);
  std::array<char, INET_ADDRSTRLEN> group{};
  inet_ntop(AF_INET, &address.group.sin_addr, group.data(), group.size());
  return std::string(group.data()) + ":" + std::to_string(ntohs(address.group.sin_port));
}

TEST(LcmUrl, WhatIsNotGivenIsLcmsOwn) {
  EXPECT_EQ(place("udpm://"), "239.255.76.67:7667");
  EXPECT_EQ(place("udpm://239.1.2.3:7000?ttl=0"), "239.1.2.3:7000");
  EXPECT_EQ(place("udpm://239.1.2.3?"), "239.1.2.3:7667");
  for (const char* url : {"udpm://", "udpm://?ttl=0"}) {
    EXPECT_EQ(parse_lcm_url(url).ttl, 0);
    EXPECT_EQ(parse_lcm_url(url).receive_buffer_bytes, std::nullopt);
  }
  EXPECT_EQ(parse_lcm_url("udpm://?recv_buf_size=4096").receive_buffer_bytes, 4096);
}

TEST(LcmUrl, HasAGroupAndAPort) {
  for (const char* place : {"127.0.0.1:7667", "no-address", "239.1.2.3:0", "239.1.2.3:65536",
                            "239.1.2.3:", "239.1.2.3:7x", "239.1.2:7000", "223.255.255.255:7667"})
    EXPECT_NE(refusal(std::string("udpm://") + place), "") << place;
}

TEST(LcmUrl, MayNotLeaveTheMachine) {
  for (const char* options :
       {"ttl=1", "ttl=01", "ttl=00", "ttl=0&ttl=3", "ttl=3&ttl=0", "ttl=", "ttl=-1", "ttl=0x0",
        "ttl= 0", "ttl=256", "ttl", "TTL=1", "recv_buf_size=1&ttl=2", "transmit_only=true"}) {
    const std::string url = std::string("udpm://239.255.76.67:7667?") + options;
    EXPECT_NE(refusal(url).find(url), std::string::npos) << options << ": " << refusal(url);
  }
  EXPECT_EQ(refusal("udpm://239.255.76.67:7667?ttl=0"), "");
}

TEST(LcmUrl, OnlyMulticast) {
  for (const char* url : {"file:///tmp/log", "tcpq://", "memq://", "udpm:/", "", "239.255.76.67:1"})
    EXPECT_NE(refusal(url).find("udpm://"), std::string::npos) << url;
}

TEST(LcmUrl, MayLeaveTheMachineIfThatIsWanted) {
  setenv("LIMBER_ALLOW_REMOTE", "1", 1);
  EXPECT_EQ(refusal("udpm://?ttl=1"), "");
  EXPECT_NE(refusal("udpm://?ttl=1&ttl=1"), "");
  EXPECT_NE(refusal("udpm://?ttl=300"), "");
  setenv("LIMBER_ALLOW_REMOTE", "yes", 1);
  EXPECT_NE(refusal("udpm://?ttl=1"), "");
  unsetenv("LIMBER_ALLOW_REMOTE");
}

}  // namespace
}  // namespace limber::test_lcm_url
