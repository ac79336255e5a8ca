#include "sim/joints/torque_sensor.h"

#include <algorithm>
#include <cmath>

#include "sim/joints/noise.h"
#include "sim/joints/relax.h"

namespace limber::sim {

TorqueSensor::TorqueSensor(const TorqueSensorConfig& config, unsigned seed)
    : config_(config), noise_key_(static_cast<std::uint64_t>(seed) * 0xD1342543DE82EF95U) {}

void TorqueSensor::update(double true_torque, double h) noexcept {
  double sample = config_.scale * true_torque + config_.bias_Nm;
  if (config_.noise_Nm > 0.0) sample += config_.noise_Nm * gaussian(++noise_key_);
  if (!started_) {
    started_ = true;
    delay_ = std::min(static_cast<std::size_t>(std::lround(config_.delay_s / h)), kMaxDelay);
    filtered_ = sample;
    past_.fill(sample);
  }
  filtered_ = relax(filtered_, sample, config_.filter_s, h).end;
  newest_ = (newest_ + 1) % past_.size();
  past_[newest_] = filtered_;
}

double TorqueSensor::reading() const noexcept {
  const double value = past_[(newest_ + past_.size() - delay_) % past_.size()];
  const double step = config_.resolution_Nm;
  return step > 0.0 ? step * std::round(value / step) : value;
}

}  // namespace limber::sim
