#include "drivers/can/link_details.h"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "common/file_descriptor.h"

namespace limber {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t kHeader = NLMSG_HDRLEN + NLMSG_ALIGN(sizeof(ifinfomsg));

template <typename Value>
bool read(Bytes bytes, Value* value) {
  if (bytes.size() < sizeof(Value)) return false;
  std::memcpy(value, bytes.data(), sizeof(Value));
  return true;
}

/// Calls `use(type, content)` for each attribute; false if one is longer than what is there.
template <typename Use>
bool for_each_attribute(Bytes bytes, Use use) {
  while (bytes.size() >= sizeof(rtattr)) {
    rtattr attribute{};
    read(bytes, &attribute);
    if (attribute.rta_len < sizeof(rtattr) || attribute.rta_len > bytes.size()) return false;
    use(attribute.rta_type & NLA_TYPE_MASK,
        bytes.subspan(RTA_LENGTH(0), attribute.rta_len - RTA_LENGTH(0)));
    bytes = bytes.subspan(std::min<std::size_t>(RTA_ALIGN(attribute.rta_len), bytes.size()));
  }
  return true;
}

std::string text_in(Bytes bytes) {
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.substr(0, text.find('\0'));
}

std::uint32_t bitrate_in(Bytes bytes) {
  can_bittiming timing{};
  return read(bytes, &timing) ? timing.bitrate : 0;
}

bool read_controller(Bytes bytes, LinkDetails* details) {
  return for_each_attribute(bytes, [&](int type, Bytes content) {
    std::uint32_t number = 0;
    can_ctrlmode mode{};
    switch (type) {
      case IFLA_CAN_BITTIMING:
        details->bitrate = bitrate_in(content);
        break;
      case IFLA_CAN_DATA_BITTIMING:
        details->data_bitrate = bitrate_in(content);
        break;
      case IFLA_CAN_CTRLMODE:
        if (read(content, &mode)) details->fd = (mode.flags & CAN_CTRLMODE_FD) != 0;
        break;
      case IFLA_CAN_RESTART_MS:
        read(content, &details->restart_ms);
        break;
      case IFLA_CAN_STATE:
        if (read(content, &number) && number <= CAN_STATE_SLEEPING)
          details->state = static_cast<CanControllerState>(number);
        break;
      default:
        break;
    }
  });
}

bool read_link_info(Bytes bytes, LinkDetails* details) {
  Bytes data;
  const bool whole = for_each_attribute(bytes, [&](int type, Bytes content) {
    if (type == IFLA_INFO_KIND) details->kind = text_in(content);
    if (type == IFLA_INFO_DATA) data = content;
  });
  return whole && (details->kind != "can" || read_controller(data, details));
}

/// A request for the link of this name, and room for the kernel's answer.
struct Request {
  nlmsghdr header{};
  ifinfomsg link{};
  rtattr name{};
  std::array<char, IFNAMSIZ> text{};
};

}  // namespace

std::optional<LinkDetails> parse_link_details(std::span<const std::byte> message) {
  nlmsghdr header{};
  if (!read(message, &header) || header.nlmsg_type != RTM_NEWLINK ||
      header.nlmsg_len > message.size() || header.nlmsg_len < kHeader)
    return std::nullopt;
  LinkDetails details;
  bool whole = true;
  whole &= for_each_attribute(message.subspan(kHeader, header.nlmsg_len - kHeader),
                              [&](int type, Bytes content) {
                                if (type == IFLA_TXQLEN) read(content, &details.queue_frames);
                                if (type == IFLA_LINKINFO)
                                  whole &= read_link_info(content, &details);
                              });
  if (!whole) return std::nullopt;
  return details;
}

std::optional<LinkDetails> read_link_details(const std::string& interface) {
  Request request;
  if (interface.empty() || interface.size() >= request.text.size()) return std::nullopt;
  const FileDescriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  const timeval patience{1, 0};
  setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  request.header.nlmsg_len = sizeof(request);
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.link.ifi_family = AF_UNSPEC;
  request.name.rta_type = IFLA_IFNAME;
  request.name.rta_len = RTA_LENGTH(IFNAMSIZ);
  interface.copy(request.text.data(), interface.size());
  if (send(socket.get(), &request, sizeof(request), 0) < 0) return std::nullopt;
  alignas(nlmsghdr) std::array<std::byte, 16'384> answer{};
  const ssize_t size = recv(socket.get(), answer.data(), answer.size(), 0);
  if (size < 0) return std::nullopt;
  return parse_link_details(std::span(answer.data(), static_cast<std::size_t>(size)));
}

}  // namespace limber
