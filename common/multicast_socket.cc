#include "common/multicast_socket.h"

#include <linux/filter.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "common/config_error.h"
#include "common/receive_buffer.h"

namespace limber {
namespace {

[[noreturn]] void refuse_with_errno(const std::string& name, const std::string& attempt) {
  if (errno == ENETUNREACH || errno == ENODEV || errno == EADDRNOTAVAIL) {
    throw ConfigError(name +
                      ": there is no multicast route on this machine. Without a network it "
                      "needs:\n  " +
                      kMulticastRouteCommands);
  }
  throw ConfigError(name + ": " + attempt + ": " + std::strerror(errno));
}

FileDescriptor open_udp(const std::string& name) {
  FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (socket.get() < 0) refuse_with_errno(name, "cannot open a socket");
  return socket;
}

template <typename Value>
void set(const std::string& name, int socket, int level, int option, const Value& value) {
  if (setsockopt(socket, level, option, &value, sizeof(value)) != 0) {
    refuse_with_errno(name, "cannot set up the socket");
  }
}

const sockaddr* generic(const sockaddr_in* address) {
  return reinterpret_cast<const sockaddr*>(address);
}

/// Sends from a port of its own, by which our frames are distinguished from all others. Not
/// connected: the kernel would fix a source address, and then prefer that address's interface to
/// the route.
FileDescriptor open_sender(const std::string& name, int ttl) {
  FileDescriptor socket = open_udp(name);
  set(name, socket.get(), IPPROTO_IP, IP_MULTICAST_TTL, ttl);
  set(name, socket.get(), IPPROTO_IP, IP_MULTICAST_LOOP, 1);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  if (bind(socket.get(), generic(&any), sizeof(any)) != 0)
    refuse_with_errno(name, "cannot bind a port to send from");
  return socket;
}

// Filters are classic BPF; they see the UDP header first. A load beyond the datagram drops it.
using Filter = std::vector<sock_filter>;
constexpr sock_filter kDrop = BPF_STMT(BPF_RET | BPF_K, 0);
constexpr sock_filter kPass = BPF_STMT(BPF_RET | BPF_K, 0xFFFFFFFFU);

/// Multicast brings a sender's datagrams back to its own host, where a port has one owner. The
/// kernel drops ours here, before they wake anybody up.
Filter drop_own(const std::string& name, int sender) {
  sockaddr_in own{};
  socklen_t size = sizeof(own);
  if (getsockname(sender, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
    refuse_with_errno(name, "cannot read the port to send from");
  }
  constexpr std::uint32_t kSourcePort = 0;
  return {BPF_STMT(BPF_LD | BPF_H | BPF_ABS, kSourcePort),
          BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ntohs(own.sin_port), 0, 1), kDrop};
}

/// Passes a short message of LCM's on this channel: its name stands behind the UDP header and eight
/// bytes, with a terminating zero. Byte by byte; the first that differs ends the comparison.
void pass_channel(std::string_view channel, Filter* filter) {
  constexpr std::uint32_t kChannel = 16;
  const auto length = static_cast<std::uint32_t>(channel.size() + 1);
  for (std::uint32_t i = 0; i < length; ++i) {
    const auto wanted = static_cast<std::uint8_t>(i < channel.size() ? channel[i] : 0);
    // To the instruction behind kPass.
    const auto past = static_cast<std::uint8_t>(2 * (length - i - 1) + 1);
    filter->push_back(BPF_STMT(BPF_LD | BPF_B | BPF_ABS, kChannel + i));
    filter->push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, wanted, 0, past));
  }
  filter->push_back(kPass);
}

void attach(const std::string& name, int receiver, Filter* filter) {
  set(name, receiver, SOL_SOCKET, SO_ATTACH_FILTER,
      sock_fprog{static_cast<unsigned short>(filter->size()), filter->data()});
}

/// The interface to which the kernel routes an address; 0 if there is none. That is also where it
/// joins a multicast group (rtnetlink(7), RTM_GETROUTE).
unsigned interface_to(const in_addr& address) {
  struct {
    nlmsghdr header;
    rtmsg route;
    rtattr attribute;
    in_addr destination;
  } request{};
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETROUTE;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.route.rtm_family = AF_INET;
  request.route.rtm_dst_len = 32;
  request.attribute.rta_type = RTA_DST;
  request.attribute.rta_len = RTA_LENGTH(sizeof address);
  request.destination = address;

  const FileDescriptor netlink(socket(AF_NETLINK, SOCK_DGRAM | SOCK_CLOEXEC, NETLINK_ROUTE));
  alignas(nlmsghdr) std::array<char, 4096> answer{};
  const bool sent = send(netlink.get(), &request, sizeof request, 0) == sizeof request;
  const ssize_t size = sent ? recv(netlink.get(), answer.data(), answer.size(), 0) : -1;

  auto* header = reinterpret_cast<nlmsghdr*>(answer.data());
  if (size < 0 || !NLMSG_OK(header, static_cast<unsigned>(size)) ||
      header->nlmsg_type != RTM_NEWROUTE)
    return 0;
  auto* route = static_cast<rtmsg*>(NLMSG_DATA(header));
  auto left = static_cast<int>(RTM_PAYLOAD(header));
  for (rtattr* item = RTM_RTA(route); RTA_OK(item, left); item = RTA_NEXT(item, left)) {
    unsigned index = 0;
    if (item->rta_type != RTA_OIF || RTA_PAYLOAD(item) != sizeof index) continue;
    std::memcpy(&index, RTA_DATA(item), sizeof index);
    return index;
  }
  return 0;
}

bool is_loopback(const std::string& interface) {
  const FileDescriptor any(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  const bool known = ioctl(any.get(), SIOCGIFFLAGS, &request) == 0;
  return known && (request.ifr_flags & IFF_LOOPBACK) != 0;
}

}  // namespace

FileDescriptor open_multicast_receiver(const std::string& name, const sockaddr_in& group,
                                       int buffer_bytes) {
  FileDescriptor socket = open_udp(name);
  set(name, socket.get(), SOL_SOCKET, SO_REUSEADDR, 1);
  set(name, socket.get(), SOL_SOCKET, SO_REUSEPORT, 1);
  set(name, socket.get(), IPPROTO_IP, IP_MULTICAST_ALL, 0);
  set_receive_buffer(socket.get(), buffer_bytes);
  // Bound to the group, not to any address: other groups on the same port stay out.
  if (bind(socket.get(), generic(&group), sizeof(group)) != 0) {
    refuse_with_errno(name, "cannot bind to port " + std::to_string(ntohs(group.sin_port)));
  }
  // No interface named: the kernel joins where its route to the group leads, and sent frames take
  // the same route.
  set(name, socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, ip_mreqn{group.sin_addr, {}, 0});
  return socket;
}

MulticastSockets open_multicast(const std::string& name, const sockaddr_in& group, int ttl,
                                int buffer_bytes) {
  MulticastSockets sockets{open_multicast_receiver(name, group, buffer_bytes),
                           open_sender(name, ttl)};
  Filter filter = drop_own(name, sockets.sender.get());
  filter.push_back(kPass);
  attach(name, sockets.receiver.get(), &filter);
  return sockets;
}

void hear_only(const std::string& name, const MulticastSockets& sockets,
               std::span<const std::string_view> channels) {
  Filter filter = drop_own(name, sockets.sender.get());
  for (const std::string_view channel : channels) pass_channel(channel, &filter);
  filter.push_back(kDrop);
  attach(name, sockets.receiver.get(), &filter);
}

std::string network_interface_of(const in_addr& group) {
  const unsigned index = interface_to(group);
  std::array<char, IF_NAMESIZE> name{};
  if (index == 0 || if_indextoname(index, name.data()) == nullptr) return "";
  return is_loopback(name.data()) ? "" : name.data();
}

}  // namespace limber
