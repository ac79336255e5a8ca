#include "drivers/can/kernel_frame.h"

#include <linux/can.h>

#include <cstring>

namespace limber {

std::size_t to_kernel(const CanFrame& frame, std::span<std::uint8_t> out) noexcept {
  canfd_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) |
               (frame.remote ? CAN_RTR_FLAG : 0U) | (frame.error ? CAN_ERR_FLAG : 0U);
  raw.len = frame.length;
  raw.flags = frame.bitrate_switch ? CANFD_BRS : 0;
  std::memcpy(raw.data, frame.data.data(), frame.length);
  const std::size_t size = frame.fd ? CANFD_MTU : CAN_MTU;
  std::memcpy(out.data(), &raw, size);
  return size;
}

bool from_kernel(std::span<const std::uint8_t> bytes, CanFrame* frame) noexcept {
  if (bytes.size() != CAN_MTU && bytes.size() != CANFD_MTU) return false;
  canfd_frame raw{};
  std::memcpy(&raw, bytes.data(), bytes.size());
  *frame = CanFrame{};
  frame->fd = bytes.size() == CANFD_MTU;
  frame->extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame->remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame->error = (raw.can_id & CAN_ERR_FLAG) != 0;
  frame->id = raw.can_id & CAN_EFF_MASK;
  frame->bitrate_switch = frame->fd && (raw.flags & CANFD_BRS) != 0;
  frame->length = raw.len;
  if (!is_possible(*frame)) return false;
  if (!frame->remote) std::memcpy(frame->data.data(), raw.data, raw.len);
  return true;
}

}  // namespace limber
