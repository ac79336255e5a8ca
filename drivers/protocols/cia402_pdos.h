// The PDOs of a CiA 402 drive in cyclic synchronous torque mode, as limber maps them. Bytes in both
// directions, no state; everything is allowed in the cycle.
//
// A cycle: command (RPDO1, synchronous) to each drive, one SYNC to all, state (TPDOs, synchronous)
// from each. The torque takes effect at the SYNC, the state is that of the SYNC.
//
//           classic CAN, as CiA 301 has it             CAN-FD
//   TPDO1   statusword, position                       all of it
//   TPDO2   velocity, torque[, current]                -
//   TPDO3   [link position, link velocity]             -
//
// The FD column is no standard: CiA 1301 (CANopen FD) has longer PDOs, too, but USDO in place of
// the SDO of CiA 301, which limber uses on both kinds of bus.
#pragma once

#include <cstdint>
#include <span>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/cia402.h"
#include "robots/loader/robot.h"

#pragma GCC visibility push(default)
namespace limber::cia402 {

/// What a drive reports, and in how many frames.
struct StateLayout {
  bool fd = false;
  bool link_encoder = false;
  /// 6077h is the sensor's, so that the current is reported beside it; else it tells the current.
  bool torque_sensor = false;
};
inline constexpr int kMostTpdos = 3;
/// That of a joint's drive; `fd`: of its bus.
inline StateLayout layout_of(const JointConfig& joint, bool fd) noexcept {
  return {fd, joint.link_encoder.present, joint.torque_sensor.present};
}

/// Thousandths of the rated torque that the joint's limit allows; more is never commanded.
std::uint32_t most_permille(const JointConfig& joint) noexcept;

struct DriveCommand {
  std::uint16_t controlword = 0;
  std::int16_t torque_permille = 0;
};

struct DriveState {
  std::uint16_t statusword = 0;
  std::int32_t position_counts = 0;
  std::int32_t velocity_counts_per_s = 0;
  std::int16_t torque_permille = 0;
  std::int16_t current_permille = 0;
  std::int32_t link_position_counts = 0;
  std::int32_t link_velocity_counts_per_s = 0;
};

/// What RPDO1 carries, in its order.
std::span<const Object> command_objects() noexcept;
/// What TPDO k = 0, 1, 2 (of the names TPDO1, 2, 3) carries, in its order; nothing: it is not used.
std::span<const Object> state_objects(const StateLayout& layout, int k) noexcept;
/// How many are used: the first ones.
int tpdos_of(const StateLayout& layout) noexcept;

/// `id`: RPDO1's, 0x200 + node.
CanFrame encode_command(const DriveCommand& command, std::uint32_t id, bool fd) noexcept;
/// The caller has matched the identifier. False if the frame is too short.
[[nodiscard]] bool decode_command(const CanFrame& frame, DriveCommand* command) noexcept;
/// One TPDO; `objects` as of state_objects().
CanFrame encode_state(const DriveState& state, std::span<const Object> objects, std::uint32_t id,
                      bool fd) noexcept;
/// Likewise; the fields of other objects stay.
[[nodiscard]] bool decode_state(const CanFrame& frame, std::span<const Object> objects,
                                DriveState* state) noexcept;

}  // namespace limber::cia402
#pragma GCC visibility pop
