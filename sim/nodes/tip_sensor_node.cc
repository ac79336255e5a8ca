#include "sim/nodes/tip_sensor_node.h"

#include <algorithm>
#include <cmath>

#include "drivers/protocols/limber_ft.h"
#include "drivers/protocols/robotous_rft.h"
#include "sim/joints/noise.h"

namespace limber::sim {
namespace {

/// Standard normal, a function of its three arguments.
double noise(std::uint32_t seed, std::int64_t t_ns, std::size_t axis) noexcept {
  return gaussian((static_cast<std::uint64_t>(seed) << 32U ^
                   static_cast<std::uint64_t>(t_ns) * 0xD1342543DE82EF95U) +
                  2U * axis);
}

}  // namespace

void TipSensorNode::update(const Vector6& F, double h, std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  const double tau = sensor_.filter_time_constant_s;
  if (!started_ || !(tau > 0.0)) {
    filtered_ = F;
  } else {
    filtered_ += -std::expm1(-h / tau) * (F - filtered_);
  }
  started_ = true;
}

WrenchReading TipSensorNode::reading() const noexcept {
  WrenchReading out;
  for (std::size_t i = 0; i < 6; ++i) {
    double value = filtered_[static_cast<Eigen::Index>(i)] + sensor_.bias[i];
    if (sensor_.noise[i] > 0.0) value += sensor_.noise[i] * noise(sensor_.noise_seed, now_ns_, i);
    if (!(std::abs(value) <= sensor_.range[i])) out.overload |= overload_bit(i);
    value = std::clamp(value, -sensor_.range[i], sensor_.range[i]);
    const double step = sensor_.resolution[i];
    out.F[i] = step > 0.0 ? step * std::round(value / step) : value;
  }
  return out;
}

std::span<const CanFrame> TipSensorNode::receive(const CanFrame& frame) noexcept {
  bool answers = false;
  std::uint8_t counter = 0;
  if (sensor_.protocol == TipSensorProtocol::kRobotousRft) {
    answers = robotous_rft::decode_request(frame, sensor_.command_id) &&
              robotous_rft::encode_reply(reading(), {sensor_.counts_per_N, sensor_.counts_per_Nm},
                                         sensor_.reply_ids, &answer_);
  } else {
    answers = limber_ft::decode_request(frame, sensor_.command_id, &counter) &&
              limber_ft::encode_reply(reading(), counter, sensor_.reply_ids[0], &answer_[0]);
  }
  if (!answers || now_ns_ < silent_until_ns_) return {};
  return std::span<const CanFrame>(answer_).first(static_cast<std::size_t>(sensor_.replies()));
}

}  // namespace limber::sim
