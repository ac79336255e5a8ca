#include "common/lcm_port.h"

#include <sys/resource.h>

#include <string>

#include "common/config_error.h"
#include "common/multicast_socket.h"

namespace limber {

namespace {

/// LCM ends the process when it finds no descriptor for a pipe.
void require_descriptors() {
  constexpr rlim_t kEnough = 64;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= kEnough) return;
  throw ConfigError("this process may have " + std::to_string(limit.rlim_cur) +
                    " open files, it needs " + std::to_string(kEnough) + "; set ulimit -n");
}

}  // namespace

std::unique_ptr<lcm::LCM> open_lcm(const std::string& url) {
  require_descriptors();
  auto lcm = std::make_unique<lcm::LCM>(checked_lcm_url(url));
  if (lcm->good()) return lcm;
  throw ConfigError(url +
                    ": LCM could not start. Without a network it needs a multicast route on this "
                    "machine:\n  " +
                    kMulticastRouteCommands);
}

LcmPort::LcmPort(const std::string& url, Use use) : lcm_(open_lcm(url)) {
  if (use == Use::kBothWays) descriptor_ = lcm_->getFileno();
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

void LcmPort::handle_waiting(int most) noexcept {
  if (descriptor_ < 0) return;
  for (int handled = 0; handled < most && lcm_->handleTimeout(0) > 0; ++handled) {
  }
}

}  // namespace limber
