#include "common/arm_plane/arm_plane.h"

#include "common/local_address.h"

namespace limber {

namespace {

std::unique_ptr<DatagramPort> open_port(const std::string& url, ArmPlaneEnd end) {
  if (is_shared_memory_address(url)) return open_shared_memory_port(url, end);
  return is_unix_address(url) ? open_unix_port(url, end) : open_multicast_port(url);
}

}  // namespace

ArmPlane::ArmPlane(const std::string& url, ArmPlaneEnd end) : port_(open_port(url, end)) {}

void ArmPlane::handle_waiting() noexcept {
  for (int handled = 0; handled < kMost; ++handled) {
    const int size = port_->receive(received_);
    if (size < 0) return;
    const auto bytes = static_cast<std::size_t>(size);
    const auto datagram =
        read_lcm_datagram(std::span(received_).first(std::min(bytes, received_.size())));
    if (!datagram || datagram->channel != channel_) continue;
    if (black_box_ != nullptr) black_box_->write(channel_, datagram->message);
    if (bytes > received_.size() || !handler_(datagram->message)) ++undecodable_;
  }
}

}  // namespace limber
