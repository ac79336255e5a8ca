#include "common/lcm_url.h"

#include <arpa/inet.h>
#include <spdlog/spdlog.h>

#include <charconv>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string_view>

#include "common/config_error.h"
#include "common/local_address.h"
#include "common/multicast_socket.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

constexpr std::string_view kScheme = "udpm://";
constexpr const char* kDefaultGroup = "239.255.76.67";
constexpr std::uint16_t kDefaultPort = 7667;

std::string from_environment(const char* variable, const char* otherwise) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0' ? value : otherwise;
}

bool remote_allowed() { return from_environment("LIMBER_ALLOW_REMOTE", "") == "1"; }

[[noreturn]] void refuse(const std::string& url, const std::string& problem) {
  throw ConfigError("LCM address " + url + ": " + problem);
}

/// Digits alone.
int read_number(const std::string& url, const std::string& what, const std::string& text, int least,
                int most) {
  int number = -1;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end || number < least || number > most) {
    refuse(url, what + " is '" + text + "', " + std::to_string(least) + " to " +
                    std::to_string(most) + " allowed");
  }
  return number;
}

int read_ttl(const std::string& url, const std::string& text) {
  const int ttl = read_number(url, "ttl", text, 0, 255);
  // "00" and "01" are numbers to one reader and others to the next.
  if (text.size() > 1 && text.front() == '0')
    refuse(url, "ttl is '" + text + "', with a leading 0");
  if (ttl == 0 || remote_allowed()) return ttl;
  refuse(url,
         "messages would leave this machine, where anybody could move the arm; use ttl=0, or set "
         "LIMBER_ALLOW_REMOTE=1 if that is what you want");
}

/// "a=1&b=2" behind the '?'
void read_options(const std::string& url, const std::string& options, LcmAddress* address) {
  std::optional<int> ttl;
  std::istringstream stream(options);
  for (std::string option; std::getline(stream, option, '&');) {
    const auto equals = option.find('=');
    const std::string key = option.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : option.substr(equals + 1);
    if (key == "recv_buf_size") {
      address->receive_buffer_bytes = read_number(url, key, value, 1, 1 << 30);
    } else if (key == "ttl") {
      if (ttl) refuse(url, "ttl is given twice");
      ttl = read_ttl(url, value);
    } else {
      refuse(url, "option '" + key + "' is not known; ttl and recv_buf_size are");
    }
  }
  address->ttl = ttl.value_or(0);
}

void read_group(const std::string& url, const std::string& text, LcmAddress* address) {
  const auto colon = text.find(':');
  const std::string group = text.substr(0, colon);
  address->group.sin_family = AF_INET;
  address->group.sin_port = htons(kDefaultPort);
  in_addr* ip = &address->group.sin_addr;
  if (inet_pton(AF_INET, group.empty() ? kDefaultGroup : group.c_str(), ip) != 1 ||
      !IN_MULTICAST(ntohl(ip->s_addr)))
    refuse(url, "'" + group + "' is no multicast group: 224.0.0.0 to 239.255.255.255 allowed");
  if (colon == std::string::npos) return;
  const int port = read_number(url, "port", text.substr(colon + 1), 1, 65535);
  address->group.sin_port = htons(static_cast<std::uint16_t>(port));
}

}  // namespace

LcmAddress parse_lcm_url(const std::string& url) {
  if (!url.starts_with(kScheme)) {
    refuse(url, "only " + std::string(kScheme) + "GROUP:PORT is supported, such as " +
                    channels::kUserPlaneUrl);
  }
  const auto question = url.find('?');
  LcmAddress address;
  read_group(url, url.substr(kScheme.size(), question - kScheme.size()), &address);
  if (question != std::string::npos) read_options(url, url.substr(question + 1), &address);
  return address;
}

std::string arm_plane_url() { return from_environment("LIMBER_ARM_URL", channels::kArmPlaneUrl); }
std::string user_plane_url() {
  return from_environment("LCM_DEFAULT_URL", channels::kUserPlaneUrl);
}

void require_local(const std::string& url, bool moves_motors) {
  if (remote_allowed() || is_unix_address(url) || is_shared_memory_address(url)) return;
  const std::string interface = network_interface_of(parse_lcm_url(url).group.sin_addr);
  if (interface.empty()) return;
  const std::string problem =
      url + " is open to the network at " + interface +
      ": this machine routes multicast there, and anybody on it can send requests to the arm. "
      "Keep it on this machine: " +
      kMulticastRouteCommands;
  if (moves_motors) {
    throw ConfigError(problem + "; or set LIMBER_ALLOW_REMOTE=1 if that is what you want");
  }
  spdlog::info("note: {}. With real motors that is refused", problem);
}

}  // namespace limber
