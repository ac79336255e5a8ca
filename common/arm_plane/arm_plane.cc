#include "common/arm_plane/arm_plane.h"

#include "common/unix_address.h"

namespace limber {

ArmPlane::ArmPlane(const std::string& url, ArmPlaneEnd end)
    : port_(is_unix_address(url) ? open_unix_port(url, end) : open_multicast_port(url)) {}

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
