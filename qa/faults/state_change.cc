#include "qa/faults/state_change.h"

#include <array>
#include <cmath>
#include <numbers>

#include "drivers/protocols/cia402_pdos.h"
#include "drivers/protocols/cubemars.h"
#include "drivers/protocols/mit.h"
#include "drivers/protocols/moteus.h"
#include "drivers/protocols/moteus_frame.h"
#include "drivers/protocols/myactuator.h"
#include "drivers/protocols/odrive.h"
#include "drivers/protocols/robstride.h"
#include "qa/faults/families.h"

namespace limber::faults {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

CanFrame with_motion_of_damiao(const CanFrame& reply, const JointConfig& joint, bool fd,
                               const MotionChange& change) {
  mit::Reply state;
  if (!mit::decode_reply(reply, joint.drive.range, &state)) return reply;
  state.position_rad += change.angle_rad;
  state.velocity_rad_per_s += change.speed_rad_per_s;
  return mit::encode_reply(state, joint.drive.range, reply.id, fd, mit::Quantiser::kRound);
}

CanFrame with_motion_of_moteus(const CanFrame& reply, const JointConfig& /*joint*/, bool /*fd*/,
                               const MotionChange& change) {
  using moteus::Register;
  using moteus::Type;
  moteus::State state;
  if (!moteus::decode_state(reply, &state)) return reply;
  const std::array measured = {static_cast<double>(state.mode),
                               state.position_turns + change.angle_rad / kTurn,
                               state.velocity_turns_per_s + change.speed_rad_per_s / kTurn,
                               state.torque_Nm, state.current_q_A};
  const std::array health = {state.temperature_degC, static_cast<double>(state.fault)};
  moteus::FrameWriter frame(reply.id);
  return frame.reply(Type::kFloat, static_cast<std::uint16_t>(Register::kMode), measured) &&
                 frame.reply(Type::kFloat, static_cast<std::uint16_t>(Register::kTemperature),
                             health)
             ? frame.frame()
             : reply;
}

CanFrame with_motion_of_cia402(const CanFrame& reply, const JointConfig& joint, bool fd,
                               const MotionChange& change) {
  const cia402::StateLayout layout = cia402::layout_of(joint, fd);
  const auto k = static_cast<int>((reply.id - joint.drive.reply_id) >> 8U);
  if (k >= cia402::tpdos_of(layout)) return reply;
  const auto objects = cia402::state_objects(layout, k);
  cia402::DriveState state;
  if (!cia402::decode_state(reply, objects, &state)) return reply;
  const auto counts = [&](double rad) {
    return static_cast<std::int32_t>(std::lround(rad / kTurn * joint.drive.counts_per_turn));
  };
  state.position_counts += counts(change.angle_rad);
  state.velocity_counts_per_s += counts(change.speed_rad_per_s);
  return cia402::encode_state(state, objects, reply.id, fd);
}

CanFrame with_motion_of_robstride(const CanFrame& reply, const JointConfig& joint, bool /*fd*/,
                                  const MotionChange& change) {
  robstride::State state;
  if (!robstride::decode_state(reply, joint.drive.range, &state)) return reply;
  state.position_rad += change.angle_rad;
  state.velocity_rad_per_s += change.speed_rad_per_s;
  return robstride::encode_state(state, joint.drive.range, robstride::Type::kState);
}

CanFrame with_motion_of_myactuator(const CanFrame& reply, const JointConfig& joint, bool /*fd*/,
                                   const MotionChange& change) {
  myactuator::Motion motion;
  if (!myactuator::decode_motion(reply, joint.drive.range, &motion)) return reply;
  motion.position_rad += change.angle_rad;
  motion.velocity_rad_per_s += change.speed_rad_per_s;
  return myactuator::encode_motion(motion, joint.drive.range, mit::Quantiser::kRound);
}

CanFrame with_motion_of_cubemars(const CanFrame& reply, const JointConfig& joint, bool /*fd*/,
                                 const MotionChange& change) {
  cubemars::State state;
  if (!cubemars::decode_state(reply, joint.drive, &state)) return reply;
  state.position_rad += change.angle_rad;
  state.velocity_rad_per_s += change.speed_rad_per_s;
  return cubemars::encode_state(state, joint.drive, mit::Quantiser::kRound);
}

CanFrame with_motion_of_odrive(const CanFrame& reply, const JointConfig& joint, bool /*fd*/,
                               const MotionChange& change) {
  const std::uint32_t node = odrive::node_of(joint.drive.command_id);
  if (!odrive::is_message(reply, node, odrive::Message::kEstimates, 8)) return reply;
  const auto moved = [&](std::size_t at, double rad) {
    return static_cast<float>(odrive::field<float>(reply, at) +
                              rad / kTurn * joint.drive.gear_ratio);
  };
  return odrive::encode(node, odrive::Message::kEstimates, moved(0, change.angle_rad),
                        moved(4, change.speed_rad_per_s));
}

CanFrame with_motion(const CanFrame& reply, const JointConfig& joint, bool fd,
                     const MotionChange& change) {
  CanFrame changed = family_of(joint.drive).with_motion(reply, joint, fd, change);
  changed.timestamp_ns = reply.timestamp_ns;
  return changed;
}

}  // namespace limber::faults
