#include "drivers/can/can_frame.h"

namespace limber {

int fd_length(int bytes) {
  constexpr std::array<int, 7> kLong = {12, 16, 20, 24, 32, 48, 64};
  if (bytes < 0) return -1;
  if (bytes <= 8) return bytes;
  for (const int length : kLong) {
    if (bytes <= length) return length;
  }
  return -1;
}

bool is_possible(const CanFrame& frame) noexcept {
  const std::uint32_t id_limit = frame.extended || frame.error ? kExtendedIdMax : kStandardIdMax;
  if (frame.id > id_limit) return false;
  if (frame.fd) {
    return !frame.remote && !frame.error && fd_length(frame.length) == frame.length;
  }
  return frame.length <= 8 && !frame.bitrate_switch && !(frame.remote && frame.error);
}

}  // namespace limber
