#include "drivers/protocols/cia402_pdos.h"

#include <array>

namespace limber::cia402 {
namespace {

using canopen::FieldReader;
using canopen::FieldWriter;

constexpr std::array kCommandObjects = {kControlword, kTargetTorque};
// All there is, in the order of the FD frame.
constexpr std::array kStateObjects = {kStatusword,    kPosition,     kVelocity,    kTorqueActual,
                                      kCurrentActual, kLinkPosition, kLinkVelocity};
constexpr std::size_t kMotorObjects = 5;

std::uint32_t value_of(const DriveState& state, const Object& object) noexcept {
  switch (object.id.number()) {
    case kStatusword.id.number():
      return state.statusword;
    case kPosition.id.number():
      return static_cast<std::uint32_t>(state.position_counts);
    case kVelocity.id.number():
      return static_cast<std::uint32_t>(state.velocity_counts_per_s);
    case kTorqueActual.id.number():
      return static_cast<std::uint16_t>(state.torque_permille);
    case kCurrentActual.id.number():
      return static_cast<std::uint16_t>(state.current_permille);
    case kLinkPosition.id.number():
      return static_cast<std::uint32_t>(state.link_position_counts);
    case kLinkVelocity.id.number():
      return static_cast<std::uint32_t>(state.link_velocity_counts_per_s);
    default:
      return 0;
  }
}

void store(const Object& object, std::uint32_t value, DriveState* state) noexcept {
  switch (object.id.number()) {
    case kStatusword.id.number():
      state->statusword = static_cast<std::uint16_t>(value);
      break;
    case kPosition.id.number():
      state->position_counts = static_cast<std::int32_t>(value);
      break;
    case kVelocity.id.number():
      state->velocity_counts_per_s = static_cast<std::int32_t>(value);
      break;
    case kTorqueActual.id.number():
      state->torque_permille = static_cast<std::int16_t>(value);
      break;
    case kCurrentActual.id.number():
      state->current_permille = static_cast<std::int16_t>(value);
      break;
    case kLinkPosition.id.number():
      state->link_position_counts = static_cast<std::int32_t>(value);
      break;
    case kLinkVelocity.id.number():
      state->link_velocity_counts_per_s = static_cast<std::int32_t>(value);
      break;
    default:
      break;
  }
}

}  // namespace

std::span<const Object> command_objects() noexcept { return kCommandObjects; }

std::span<const Object> state_objects(const StateLayout& layout, int k) noexcept {
  const std::span<const Object> all = kStateObjects;
  if (layout.fd && k > 0) return {};
  if (layout.fd) return layout.link_encoder ? all : all.first(kMotorObjects);
  switch (k) {
    case 0:
      return all.first(2);
    case 1:
      return all.subspan(2, layout.torque_sensor ? 3 : 2);
    case 2:
      return layout.link_encoder ? all.subspan(kMotorObjects) : std::span<const Object>{};
    default:
      return {};
  }
}

int tpdos_of(const StateLayout& layout) noexcept {
  int count = 0;
  while (!state_objects(layout, count).empty()) ++count;
  return count;
}

CanFrame encode_command(const DriveCommand& command, std::uint32_t id, bool fd) noexcept {
  FieldWriter fields(id, fd);
  fields.put(command.controlword, 2);
  fields.put(static_cast<std::uint16_t>(command.torque_permille), 2);
  return fields.frame();
}

bool decode_command(const CanFrame& frame, DriveCommand* command) noexcept {
  FieldReader fields(frame);
  const std::uint32_t controlword = fields.take(2);
  const std::int32_t torque = fields.take_signed(2);
  if (!fields.complete() || frame.remote || frame.error) return false;
  *command = {static_cast<std::uint16_t>(controlword), static_cast<std::int16_t>(torque)};
  return true;
}

CanFrame encode_state(const DriveState& state, std::span<const Object> objects, std::uint32_t id,
                      bool fd) noexcept {
  FieldWriter fields(id, fd);
  for (const Object& object : objects) fields.put(value_of(state, object), object.bytes);
  return fields.frame();
}

bool decode_state(const CanFrame& frame, std::span<const Object> objects,
                  DriveState* state) noexcept {
  FieldReader fields(frame);
  DriveState read = *state;
  for (const Object& object : objects) store(object, fields.take(object.bytes), &read);
  if (!fields.complete() || frame.remote || frame.error) return false;
  *state = read;
  return true;
}

std::uint32_t most_permille(const JointConfig& joint) noexcept {
  constexpr double kMost = 32767.0;
  const double limit = std::min(joint.torque_limit_Nm, joint.drive.range.torque_Nm);
  const double permille = 1000.0 * limit / joint.drive.rated_torque_Nm;
  return static_cast<std::uint32_t>(std::min(std::floor(permille * (1.0 + 1e-12)), kMost));
}

}  // namespace limber::cia402
