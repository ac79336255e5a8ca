#include "drivers/protocols/myactuator.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

namespace limber::myactuator {
namespace {

constexpr double kAngleCount_rad = std::numbers::pi / 18000.0;  // 0.01 degree
constexpr std::uint32_t kTenDigits = 1'000'000'000;
constexpr std::uint32_t kFirstV44Day = kFirstV44 / 100;

/// Of a type of 8, 16 or 32 bits; NaN gives 0.
template <typename Integer>
Integer whole(double value) noexcept {
  using Limits = std::numeric_limits<Integer>;
  if (std::isnan(value)) return 0;
  return static_cast<Integer>(std::clamp(std::round(value), static_cast<double>(Limits::min()),
                                         static_cast<double>(Limits::max())));
}

template <typename Integer>
void put(CanFrame* frame, std::size_t at, Integer value) noexcept {
  for (std::size_t i = 0; i < sizeof value; ++i)
    frame->data[at + i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> 8 * i);
}

template <typename Integer>
Integer get(const CanFrame& frame, std::size_t at) noexcept {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i)
    value |= static_cast<std::uint32_t>(frame.data[at + i]) << 8 * i;
  return static_cast<Integer>(value);
}

CanFrame frame_of(std::uint32_t id, Order order) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.length = 8;
  frame.data[0] = static_cast<std::uint8_t>(order);
  return frame;
}

CanFrame answer_frame(Order order, int motor) noexcept {
  return frame_of(kAnswerId + static_cast<std::uint32_t>(motor), order);
}

struct ErrorText {
  std::uint16_t bit;
  const char* text;
};
constexpr std::array kErrors = {
    ErrorText{0x0002, "stall"},          ErrorText{kUnderVoltage, "under-voltage"},
    ErrorText{0x0008, "over-voltage"},   ErrorText{0x0010, "over-current"},
    ErrorText{0x0040, "too much power"}, ErrorText{0x0080, "calibration not written"},
    ErrorText{0x0100, "too fast"},       ErrorText{0x0800, "board too hot"},
    ErrorText{0x1000, "motor too hot"},  ErrorText{0x2000, "encoder not calibrated"},
    ErrorText{0x4000, "encoder error"},
};

}  // namespace

bool only_reads(std::uint8_t order) noexcept {
  // Gains, acceleration, encoder, angles, mode, states, run time, version, model.
  constexpr std::array<std::uint8_t, 15> kReads = {0x30, 0x42, 0x60, 0x61, 0x62, 0x70, 0x90, 0x92,
                                                   0x94, 0x9A, 0x9C, 0x9D, 0xB1, 0xB2, 0xB5};
  return std::ranges::find(kReads, order) != kReads.end();
}

CanFrame order_frame(Order order, int motor, std::uint32_t value) noexcept {
  CanFrame frame = frame_of(kOrderId + static_cast<std::uint32_t>(motor), order);
  put(&frame, 4, value);
  return frame;
}

CanFrame bit_rate_frame(int motor, std::uint8_t code) noexcept {
  return order_frame(Order::kBitRate, motor, std::uint32_t{code} << 24U);
}

CanFrame function_frame(Function function, int motor, std::uint32_t value) noexcept {
  CanFrame frame = order_frame(Order::kFunction, motor, value);
  frame.data[1] = static_cast<std::uint8_t>(function);
  return frame;
}

CanFrame model_frame(int motor, int block) noexcept {
  CanFrame frame = order_frame(Order::kModel, motor);
  frame.data[1] = 1;
  frame.data[2] = static_cast<std::uint8_t>(block);
  return frame;
}

bool is_frame(const CanFrame& frame, std::uint32_t id) noexcept {
  return has_id(frame, id) && !frame.remote && !frame.fd && frame.length == 8;
}

bool answers(const CanFrame& frame, Order order, int motor) noexcept {
  return is_frame(frame, kAnswerId + static_cast<std::uint32_t>(motor)) &&
         frame.data[0] == static_cast<std::uint8_t>(order);
}

std::uint32_t value_of(const CanFrame& frame) noexcept { return get<std::uint32_t>(frame, 4); }

void ModelText::add(const CanFrame& frame) noexcept {
  const std::size_t first = frame.data[1] == 1 ? 3 : 1;  // the block is repeated before it
  for (std::size_t i = first; i < 8 && frame.data[i] != 0 && size_ < letters_.size(); ++i)
    letters_[size_++] = static_cast<char>(std::clamp<int>(frame.data[i], ' ', '~'));
}

int ModelText::series() const noexcept {
  int series = 0;
  const std::size_t x = text().find('X');
  if (x != std::string_view::npos)
    std::from_chars(letters_.data() + x + 1, letters_.data() + size_, series);
  return series;
}

Firmware firmware_of(std::uint32_t version) noexcept {
  const std::uint32_t date = version < kTenDigits ? version : version / 100;
  const std::uint32_t month = date / 100 % 100;
  const std::uint32_t day = date % 100;
  if (date < 20100000 || date > 20991231 || month < 1 || month > 12 || day < 1 || day > 31)
    return Firmware::kUnknown;
  if (version < kTenDigits) return date < kFirstV44Day ? Firmware::kV42 : Firmware::kUnknown;
  return version < kFirstV44 ? Firmware::kV42 : Firmware::kV44;
}

Firmware firmware_of(const CommandRange& range) noexcept {
  return range.kd_Nms_per_rad > 5.0 ? Firmware::kV44 : Firmware::kV42;
}

const char* name_of(Firmware firmware) noexcept {
  switch (firmware) {
    case Firmware::kV42:
      return "V4.2";
    case Firmware::kV44:
      return "V4.4";
    case Firmware::kUnknown:
      break;
  }
  return "unknown";
}

CanFrame encode_motion(const Motion& motion, const CommandRange& range,
                       mit::Quantiser quantiser) noexcept {
  mit::Reply reply;
  reply.position_rad = motion.position_rad;
  reply.velocity_rad_per_s = motion.velocity_rad_per_s;
  reply.torque_Nm = motion.torque_Nm;
  CanFrame frame =
      mit::encode_reply(reply, range, kMotionAnswerId + motion.motor, false, quantiser);
  frame.data[0] = motion.motor;
  return frame;
}

bool decode_motion(const CanFrame& frame, const CommandRange& range, Motion* motion) noexcept {
  mit::Reply reply;
  if (!is_frame(frame, kMotionAnswerId + frame.data[0]) || !mit::decode_reply(frame, range, &reply))
    return false;
  *motion = {frame.data[0], reply.position_rad, reply.velocity_rad_per_s, reply.torque_Nm};
  return true;
}

CanFrame encode_status(const Status& status, int motor) noexcept {
  CanFrame frame = answer_frame(Order::kStatus, motor);
  put(&frame, 1, whole<std::int8_t>(status.temperature_degC));
  frame.data[3] = status.brake_released ? 1 : 0;
  put(&frame, 4, whole<std::uint16_t>(10.0 * status.supply_V));
  put(&frame, 6, status.errors);
  return frame;
}

Status decode_status(const CanFrame& frame) noexcept {
  return {get<std::int8_t>(frame, 1), frame.data[3] == 1, 0.1 * get<std::uint16_t>(frame, 4),
          get<std::uint16_t>(frame, 6)};
}

std::string errors_text(std::uint16_t errors) {
  std::string text;
  for (const ErrorText& error : kErrors) {
    if ((errors & error.bit) == 0) continue;
    text += (text.empty() ? "" : ", ") + std::string(error.text);
    errors = static_cast<std::uint16_t>(errors & ~error.bit);
  }
  if (errors != 0) text += std::string(text.empty() ? "" : ", ") + "another error";
  return text;
}

CanFrame encode_angle(double angle_rad, int motor) noexcept {
  CanFrame frame = answer_frame(Order::kAngle, motor);
  put(&frame, 4, whole<std::int32_t>(angle_rad / kAngleCount_rad));
  return frame;
}

double decode_angle(const CanFrame& frame) noexcept {
  return get<std::int32_t>(frame, 4) * kAngleCount_rad;
}

}  // namespace limber::myactuator
