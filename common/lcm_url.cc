#include "common/lcm_url.h"

#include <arpa/inet.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <netinet/in.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string_view>

#include "common/config_error.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

constexpr std::string_view kScheme = "udpm://";
constexpr std::string_view kDefaultGroup = "239.255.76.67";

std::string from_environment(const char* variable, const char* otherwise) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0' ? value : otherwise;
}

bool remote_allowed() { return from_environment("LIMBER_ALLOW_REMOTE", "") == "1"; }

[[noreturn]] void refuse(const std::string& url, const std::string& problem) {
  throw ConfigError("LCM address " + url + ": " + problem);
}

void check_ttl(const std::string& url, const std::string& ttl) {
  const bool is_number = !ttl.empty() && ttl.size() <= 3 &&
                         std::ranges::all_of(ttl, [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number || std::stoi(ttl) > 255) refuse(url, "ttl is '" + ttl + "', 0 to 255 allowed");
  if (ttl != "0" && !remote_allowed()) {
    refuse(url,
           "messages would leave this machine, where anybody could move the arm; use ttl=0, or set "
           "LIMBER_ALLOW_REMOTE=1 if that is what you want");
  }
}

/// "a=1&b=2" behind the '?'
void check_options(const std::string& url, const std::string& options) {
  bool has_ttl = false;
  std::istringstream stream(options);
  for (std::string option; std::getline(stream, option, '&');) {
    const auto equals = option.find('=');
    const std::string key = option.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : option.substr(equals + 1);
    if (key != "ttl" && key != "recv_buf_size")
      refuse(url, "option '" + key + "' is not known; ttl and recv_buf_size are");
    if (key != "ttl") continue;
    if (has_ttl) refuse(url, "ttl is given twice");
    has_ttl = true;
    check_ttl(url, value);
  }
}

std::string group_of(const std::string& url) {
  const std::string_view rest = std::string_view(url).substr(kScheme.size());
  const std::string_view group = rest.substr(0, rest.find_first_of(":?"));
  return std::string(group.empty() ? kDefaultGroup : group);
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

  const int netlink = socket(AF_NETLINK, SOCK_DGRAM | SOCK_CLOEXEC, NETLINK_ROUTE);
  if (netlink < 0) return 0;
  alignas(nlmsghdr) std::array<char, 4096> answer{};
  const bool sent = send(netlink, &request, sizeof request, 0) == sizeof request;
  const ssize_t size = sent ? recv(netlink, answer.data(), answer.size(), 0) : -1;
  close(netlink);

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
  const int any = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  const bool known = any >= 0 && ioctl(any, SIOCGIFFLAGS, &request) == 0;
  if (any >= 0) close(any);
  return known && (request.ifr_flags & IFF_LOOPBACK) != 0;
}

}  // namespace

std::string checked_lcm_url(const std::string& url) {
  if (!url.starts_with(kScheme)) {
    refuse(url, "only " + std::string(kScheme) + "GROUP:PORT is supported, such as " +
                    channels::kUserPlaneUrl);
  }
  const auto question = url.find('?');
  const bool has_options = question != std::string::npos;
  const std::string options = has_options ? url.substr(question + 1) : "";
  check_options(url, options);
  if (options.find("recv_buf_size=") != std::string::npos) return url;
  return url + (!has_options ? "?" : options.empty() ? "" : "&") + "recv_buf_size=2097152";
}

std::string no_multicast_route(const std::string& url) {
  return url +
         ": LCM could not start. Without a network it needs a multicast route on this machine:\n"
         "  sudo ip link set lo multicast on\n  sudo ip route add 224.0.0.0/4 dev lo";
}

std::string arm_plane_url() { return from_environment("LIMBER_ARM_URL", channels::kArmPlaneUrl); }
std::string user_plane_url() {
  return from_environment("LCM_DEFAULT_URL", channels::kUserPlaneUrl);
}

std::string network_interface_of(const std::string& url) {
  in_addr group{};
  if (inet_pton(AF_INET, group_of(url).c_str(), &group) != 1) return "";
  const unsigned index = interface_to(group);
  std::array<char, IF_NAMESIZE> name{};
  if (index == 0 || if_indextoname(index, name.data()) == nullptr) return "";
  return is_loopback(name.data()) ? "" : name.data();
}

void require_local(const std::string& url, bool moves_motors) {
  if (remote_allowed()) return;
  const std::string interface = network_interface_of(url);
  if (interface.empty()) return;
  const std::string problem =
      url + " is open to the network at " + interface +
      ": this machine routes multicast there, and anybody on it can send requests to the arm. "
      "Keep it on this machine: sudo ip link set lo multicast on && sudo ip route add 224.0.0.0/4 "
      "dev lo";
  if (moves_motors) {
    throw ConfigError(problem + "; or set LIMBER_ALLOW_REMOTE=1 if that is what you want");
  }
  spdlog::warn("warning: {}. With real motors that is refused", problem);
}

}  // namespace limber
