// The state of a CiA 402 drive, put together of the TPDOs that answer one SYNC.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/families/drive_family.h"
#include "drivers/protocols/cia402_pdos.h"

namespace limber {

/// Allowed in the cycle throughout. The TPDOs may come in any order, each once.
class Cia402State {
 public:
  Cia402State(const cia402::StateLayout& layout, std::uint8_t node)
      : layout_(layout), node_(node), count_(cia402::tpdos_of(layout)) {}

  /// A new SYNC is on its way: nothing is there yet.
  void begin() noexcept { taken_.fill(false); }
  /// kWhole: values() are those of one SYNC.
  StateReading take(const CanFrame& frame) noexcept;
  const cia402::DriveState& values() const noexcept { return state_; }
  /// Whether the frame is one of the TPDOs, whatever its content.
  bool is_part(const CanFrame& frame) const noexcept { return tpdo_of(frame) < count_; }
  int tpdos() const noexcept { return count_; }

 private:
  /// 0, 1, ..; count_ if it is none.
  int tpdo_of(const CanFrame& frame) const noexcept;

  cia402::StateLayout layout_;
  std::uint8_t node_;
  int count_;
  std::array<bool, cia402::kMostTpdos> taken_{};
  cia402::DriveState state_;
};

}  // namespace limber
