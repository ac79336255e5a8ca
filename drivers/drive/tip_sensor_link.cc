#include "drivers/drive/tip_sensor_link.h"

#include <algorithm>

#include "drivers/protocols/limber_ft.h"
#include "drivers/protocols/robotous_rft.h"

namespace limber {

CanFrame TipSensorLink::next_frame() noexcept {
  half_ = false;  // halves of two replies do not make a reading
  if (sensor_.protocol == TipSensorProtocol::kRobotousRft)
    return robotous_rft::encode_request(sensor_.command_id);
  return limber_ft::encode_request(sensor_.command_id, ++counter_);
}

void TipSensorLink::begin_cycle() noexcept {
  if (age_cycles_ < kNever - 1) ++age_cycles_;
}

bool TipSensorLink::is_mine(std::size_t on_bus, const CanFrame& frame) const noexcept {
  if (on_bus != bus() || frame.extended) return false;
  return frame.id == sensor_.reply_ids[0] ||
         (sensor_.replies() == 2 && frame.id == sensor_.reply_ids[1]);
}

void TipSensorLink::add_receive_filters(std::vector<CanFilter>* filters) const {
  for (int i = 0; i < sensor_.replies(); ++i)
    filters->push_back(exactly(sensor_.reply_ids[static_cast<std::size_t>(i)]));
}

void TipSensorLink::receive(const CanFrame& frame, bool late) noexcept {
  if (sensor_.replies() == 2 && frame.id == sensor_.reply_ids[0]) {
    first_ = frame;
    half_ = true;
    return;
  }
  WrenchReading reading;
  const std::int32_t age_cycles = late ? 1 : 0;
  if (age_cycles_ <= age_cycles || !decode(frame, &reading)) {
    ++invalid_;
    return;
  }
  reading_ = reading;
  age_cycles_ = age_cycles;
  if (late) ++late_;
}

bool TipSensorLink::decode(const CanFrame& frame, WrenchReading* reading) noexcept {
  if (sensor_.protocol == TipSensorProtocol::kLimberFt) {
    std::uint8_t counter = 0;
    return limber_ft::decode_reply(frame, &counter, reading) && counter == counter_;
  }
  const bool whole = half_;
  half_ = false;
  return whole && robotous_rft::decode_reply(
                      first_, frame, {sensor_.counts_per_N, sensor_.counts_per_Nm}, reading);
}

std::int8_t TipSensorLink::state() const noexcept {
  if (age_cycles_ > bridged_cycles_ || reading_.overload != 0) return joint_state_t::SENSOR_ERROR;
  return fresh() ? joint_state_t::SENSOR_FRESH : joint_state_t::SENSOR_STALE;
}

void TipSensorLink::write_state(joint_state_t* state_out) const noexcept {
  std::copy_n(reading_.F.begin(), 6, state_out->F_sensor);
  state_out->sensor_age_cycles = age_cycles_;
  state_out->sensor_state = state();
}

void TipSensorLink::write_status(driver_status_t* status) const noexcept {
  status->sensor_replies_late = late_;
  status->sensor_replies_lost = lost_;
  status->sensor_replies_invalid = invalid_;
}

}  // namespace limber
