#include "drivers/can/virtual_frame.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "drivers/can/message_pack.h"

namespace limber {
namespace {

constexpr double kLatest_s = 9e9;  // what 64 bits of nanoseconds hold

struct Fields {
  std::optional<std::uint64_t> id;
  std::optional<std::uint64_t> dlc;
  std::span<const std::uint8_t> data;
  double time_s = 0.0;
  bool extended = true;
  bool remote = false;
  bool error = false;
  bool fd = false;
  bool bitrate_switch = false;
};

bool read_optional_integer(message_pack::Reader* reader,
                           std::optional<std::uint64_t>* value) noexcept {
  std::uint64_t number = 0;
  if (!reader->integer(&number)) return false;
  *value = number;
  return true;
}

bool read_value(std::string_view key, message_pack::Reader* reader, Fields* fields) noexcept {
  if (key == "arbitration_id") return read_optional_integer(reader, &fields->id);
  if (key == "dlc") return reader->nil() || read_optional_integer(reader, &fields->dlc);
  if (key == "data") return reader->nil() || reader->binary(&fields->data);
  if (key == "timestamp") return reader->real(&fields->time_s) || reader->skip();
  if (key == "is_extended_id") return reader->boolean(&fields->extended);
  if (key == "is_remote_frame") return reader->boolean(&fields->remote);
  if (key == "is_error_frame") return reader->boolean(&fields->error);
  if (key == "is_fd") return reader->boolean(&fields->fd);
  if (key == "bitrate_switch") return reader->boolean(&fields->bitrate_switch);
  return reader->skip();
}

bool to_frame(const Fields& fields, CanFrame* frame) noexcept {
  const std::uint64_t length = fields.dlc.value_or(fields.data.size());
  if (!fields.id || *fields.id > kExtendedIdMax || length > frame->data.size()) return false;
  if (!fields.extended && *fields.id > kStandardIdMax) return false;
  if (!fields.remote && length != fields.data.size()) return false;
  *frame = CanFrame{};
  frame->id = static_cast<std::uint32_t>(*fields.id);
  frame->extended = fields.extended;
  frame->remote = fields.remote;
  frame->error = fields.error;
  frame->fd = fields.fd;
  frame->bitrate_switch = fields.bitrate_switch;
  frame->length = static_cast<std::uint8_t>(length);
  if (std::abs(fields.time_s) < kLatest_s) frame->timestamp_ns = std::llround(fields.time_s * 1e9);
  if (!fields.remote) std::copy(fields.data.begin(), fields.data.end(), frame->data.begin());
  return is_possible(*frame);
}

}  // namespace

std::size_t encode_datagram(const CanFrame& frame, std::span<std::uint8_t> out) noexcept {
  message_pack::Writer writer(out);
  const auto boolean = [&](std::string_view key, bool value) {
    writer.text(key);
    writer.boolean(value);
  };
  writer.map(11);
  writer.text("timestamp");
  writer.real(static_cast<double>(frame.timestamp_ns) * 1e-9);
  writer.text("arbitration_id");
  writer.integer(frame.id);
  // An error frame's id holds class bits, which may need more than 11 bits.
  boolean("is_extended_id", frame.extended || frame.id > kStandardIdMax);
  boolean("is_remote_frame", frame.remote);
  boolean("is_error_frame", frame.error);
  writer.text("channel");
  writer.nil();
  writer.text("dlc");
  writer.integer(frame.length);
  writer.text("data");
  writer.binary(std::span(frame.data).first(frame.remote ? 0 : frame.length));
  boolean("is_fd", frame.fd);
  boolean("bitrate_switch", frame.bitrate_switch);
  boolean("error_state_indicator", false);
  return writer.size();
}

bool decode_datagram(std::span<const std::uint8_t> datagram, CanFrame* frame) noexcept {
  message_pack::Reader reader(datagram);
  std::uint64_t pairs = 0;
  if (!reader.map(&pairs)) return false;
  Fields fields;
  for (; pairs > 0; --pairs) {
    std::string_view key;
    if (!reader.text(&key) || !read_value(key, &reader, &fields)) return false;
  }
  return reader.at_end() && to_frame(fields, frame);
}

}  // namespace limber
