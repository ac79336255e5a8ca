#include "drivers/families/cia402_state.h"

#include <algorithm>

namespace limber {

int Cia402State::tpdo_of(const CanFrame& frame) const noexcept {
  int k = 0;
  while (k < count_ && !has_id(frame, canopen::tpdo_id(k, node_))) ++k;
  return k;
}

StateReading Cia402State::take(const CanFrame& frame) noexcept {
  const int k = tpdo_of(frame);
  if (k == count_) return StateReading::kNone;
  bool& taken = taken_[static_cast<std::size_t>(k)];
  if (taken || !cia402::decode_state(frame, cia402::state_objects(layout_, k), &state_))
    return StateReading::kNone;
  taken = true;
  return std::ranges::count(taken_, true) == count_ ? StateReading::kWhole : StateReading::kPart;
}

}  // namespace limber
