// The kernel's count of what a process has not read yet: seen on a socket of this process.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/file_descriptor.h"
#include "common/reader_backlog.h"

namespace limber::test_reader_backlog {
namespace {

struct Receiver {
  Receiver() : socket(::socket(AF_INET, SOCK_DGRAM, 0)) {
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(socket.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
  }
  void receive(const std::string& bytes) const {
    const FileDescriptor sender(::socket(AF_INET, SOCK_DGRAM, 0));
    ASSERT_EQ(sendto(sender.get(), bytes.data(), bytes.size(), 0,
                     reinterpret_cast<const sockaddr*>(&address), sizeof address),
              static_cast<ssize_t>(bytes.size()));
  }
  FileDescriptor socket;
  sockaddr_in address{};
};

TEST(ReaderBacklog, IsWhatWaitsInTheBuffer) {
  const Receiver receiver;
  const ReaderBacklog backlog({getpid()});
  ASSERT_TRUE(backlog.watches_any());
  EXPECT_EQ(backlog.bytes(), 0);
  receiver.receive(std::string(1000, 'x'));
  const std::int64_t one = backlog.bytes();
  EXPECT_GE(one, 1000) << "and what the kernel adds";
  receiver.receive(std::string(1000, 'x'));
  EXPECT_EQ(backlog.bytes(), 2 * one);
  std::array<char, 1000> bytes{};
  for (int i = 0; i < 2; ++i)
    ASSERT_EQ(recv(receiver.socket.get(), bytes.data(), bytes.size(), 0), 1000);
  EXPECT_EQ(backlog.bytes(), 0);
}

TEST(ReaderBacklog, OfOthersIsNotCounted) {
  const ReaderBacklog before({getpid()});  // has no socket yet
  const Receiver receiver;
  receiver.receive("x");
  EXPECT_EQ(before.bytes(), 0);
  EXPECT_FALSE(ReaderBacklog({}).watches_any());
  EXPECT_FALSE(ReaderBacklog({999'999'999}).watches_any()) << "no such process";
}

}  // namespace
}  // namespace limber::test_reader_backlog
