#include "common/lcm_port.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "common/config_error.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

std::string from_environment(const char* variable, const char* otherwise) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0' ? value : otherwise;
}

}  // namespace

std::string checked_lcm_url(const std::string& url) {
  const auto ttl = url.find("ttl=");
  const char* allow = std::getenv("LIMBER_ALLOW_REMOTE");
  const bool stays = ttl == std::string::npos || url.compare(ttl, 5, "ttl=0") == 0;
  if (!stays && (allow == nullptr || std::strcmp(allow, "1") != 0)) {
    throw ConfigError(
        url +
        ": messages would leave this machine, where anybody could move the arm; use ttl=0, or set "
        "LIMBER_ALLOW_REMOTE=1 if that is what you want");
  }
  return url + (url.find('?') == std::string::npos ? "?" : "&") + "recv_buf_size=2097152";
}

std::string no_multicast_route(const std::string& url) {
  return url +
         ": LCM could not start. Without a network it needs a multicast route on this machine:\n"
         "  sudo ip link set lo multicast on\n  sudo ip route add 224.0.0.0/4 dev lo";
}

LcmPort::LcmPort(const std::string& url) : lcm_(std::make_unique<lcm::LCM>(checked_lcm_url(url))) {
  if (!lcm_->good()) throw ConfigError(no_multicast_route(url));
  descriptor_ = lcm_->getFileno();
}

bool LcmPort::publish_bytes(const char* channel, int size) noexcept {
  return lcm_publish(lcm_->getUnderlyingLCM(), channel, buffer_.data(),
                     static_cast<unsigned>(size)) == 0;
}

void LcmPort::subscribe_bytes(const char* channel, int queue, BytesHandler handler) {
  handlers_.push_back(std::make_unique<BytesHandler>(std::move(handler)));
  auto call = [](const lcm::ReceiveBuffer* buffer, const std::string&, BytesHandler* function) {
    (*function)(buffer->data, buffer->data_size);
  };
  void (*plain)(const lcm::ReceiveBuffer*, const std::string&, BytesHandler*) = call;
  lcm_->subscribeFunction(channel, plain, handlers_.back().get())->setQueueCapacity(queue);
}

void LcmPort::handle_waiting() noexcept {
  while (lcm_->handleTimeout(0) > 0) {
  }
}

std::string arm_plane_url() { return from_environment("LIMBER_ARM_URL", channels::kArmPlaneUrl); }
std::string user_plane_url() {
  return from_environment("LCM_DEFAULT_URL", channels::kUserPlaneUrl);
}

}  // namespace limber
