// Faults of what a drive measures, of which drive it is, and of two things at once.
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "drivers/can/lockstep_frame.h"
#include "drivers/protocols/mit.h"
#include "qa/faults/fault_table.h"
#include "qa/faults/state_change.h"

namespace limber::faults {
namespace {

using Frames = std::vector<CanFrame>;
using Begin = std::function<void(FaultStage*)>;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

void event(FaultStage* stage, std::int8_t fault, double duration_s) {
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_FAULT;
  event.fault = fault;
  event.duration_s = duration_s;
  stage->simulator().event(event);
}

void frozen_encoder(FaultStage* stage) {
  event(stage, scenario_event_t::FAULT_FROZEN_ENCODER, 0.0);
}

/// The drive reports a kelvin more than its limit_temperature_degC.
Begin hot(double duration_s) {
  return [=](FaultStage* stage) { event(stage, scenario_event_t::FAULT_HOT, duration_s); };
}

/// A payload of so many kg, or none, in the place of what is there.
Begin payload(double mass_kg) {
  return [mass_kg](FaultStage* stage) {
    scenario_event_t event{};
    event.kind = scenario_event_t::EVENT_PAYLOAD;
    event.payload_mass_kg = mass_kg;
    stage->simulator().event(event);
  };
}

/// The angle runs away from the truth by so much a cycle; the speed reported stays true.
Begin drift(double rad_per_cycle) {
  return [rad_per_cycle](FaultStage* stage) {
    const auto frames = stage->joint().drive.frames.replies.size();
    stage->change_replies(
        [=, count = std::size_t{0}](const CanFrame& frame, Frames* instead) mutable {
          const double angle_rad = rad_per_cycle * static_cast<double>(count++ / frames + 1);
          instead->push_back(
              with_motion(frame, stage->joint(), stage->bus_config().fd, {.angle_rad = angle_rad}));
        });
  };
}

Begin turned(double angle_rad) {
  return [angle_rad](FaultStage* stage) {
    stage->change_replies([=](const CanFrame& frame, Frames* instead) {
      instead->push_back(
          with_motion(frame, stage->joint(), stage->bus_config().fd, {.angle_rad = angle_rad}));
    });
  };
}

/// A field of Damiao's replies is replaced.
template <typename Change>
Begin damiao_replies(Change change) {
  return [change](FaultStage* stage) {
    stage->change_replies([=](const CanFrame& frame, Frames* instead) {
      const CommandRange& range = stage->joint().drive.range;
      instead->push_back(frame);
      mit::Reply reply;
      if (!mit::decode_reply(frame, range, &reply)) return;
      change(range, &reply);
      CanFrame& changed = instead->back();
      const std::int64_t time_ns = frame.timestamp_ns;
      changed = mit::encode_reply(reply, range, frame.id, frame.fd, mit::Quantiser::kRound);
      changed.timestamp_ns = time_ns;
    });
  };
}

/// The drive makes the opposite of the torque it is told.
void opposite_torque(FaultStage* stage) {
  const DriveConfig& drive = stage->joint().drive;
  stage->bus().set_sent_change([&drive](const CanFrame& frame) -> std::optional<CanFrame> {
    mit::Command command;
    CanFrame changed = frame;
    if (!has_id(frame, drive.command_id) || !mit::decode_command(frame, drive.range, &command))
      return changed;
    command.torque_Nm = -command.torque_Nm;
    return mit::encode_command(command, drive.range, frame.id, frame.fd, mit::Quantiser::kRound,
                               &changed)
               ? changed
               : frame;
  });
}

/// No command reaches any drive.
void commands_lost(FaultStage* stage) {
  for (TamperedBus* bus : stage->buses()) {
    bus->set_sent_change([](const CanFrame& frame) -> std::optional<CanFrame> {
      if (frame.error || !lockstep::is_tick(frame)) return std::nullopt;
      return frame;
    });
  }
}

void silent_motor(FaultStage* stage) {
  stage->change_replies([](const CanFrame&, Frames*) {});
}

void silent_controller(FaultStage* stage) {
  stage->change_answers([](const joint_command_t&, std::vector<joint_command_t>*) {});
}

void motor_and_controller_silent(FaultStage* stage) {
  silent_motor(stage);
  silent_controller(stage);
}

void drive_error_while_the_controller_is_silent(FaultStage* stage) {
  silent_controller(stage);
  event(stage, scenario_event_t::FAULT_DRIVE_ERROR, 0.0);
}

void swap_first_two(Robot* robot) {
  DriveConfig& one = robot->joints[0].drive;
  DriveConfig& other = robot->joints[1].drive;
  std::swap(one.command_id, other.command_id);
  std::swap(one.reply_id, other.reply_id);
}

constexpr int kFromStart = 2000;  // cycles: enabled, and a second of motion

}  // namespace

std::vector<Fault> feedback_faults() {
  const std::vector<std::string_view> only_damiao = {"damiao_mit"};
  const std::vector<std::string_view> with_thermometer = {"damiao_mit", "moteus"};
  std::vector<Fault> all = {
      {.name = "the encoder freezes",
       .begin = frozen_encoder,
       .most_cycles = 30,
       .watched_cycles = 1000},
      {.name = "the angle drifts by 2 rad/s",
       .begin = drift(0.002),
       .most_cycles = 100,
       .watched_cycles = 1000},
      {.name = "the angle jumps by a turn", .begin = turned(kTurn_rad), .most_cycles = 4},
      {.name = "the speed reads the same from now on",
       .begin = damiao_replies([](const CommandRange& range, mit::Reply* reply) {
         reply->velocity_rad_per_s = 0.9 * range.velocity_rad_per_s;
       }),
       .most_cycles = 5,
       .protocols = only_damiao},
      {.name = "the torque reads the end of its range",
       .begin = damiao_replies([](const CommandRange& range, mit::Reply* reply) {
         reply->torque_Nm = range.torque_Nm;
       }),
       .most_cycles = 102,
       .watched_cycles = 500,
       .protocols = only_damiao},
      {.name = "the drive makes the opposite torque",
       .begin = opposite_torque,
       .most_cycles = 20,
       .watched_cycles = 1000,
       .protocols = only_damiao},
      {.name = "the drive is too hot",
       .begin = hot(0.0),
       .most_cycles = 12,
       .watched_cycles = 500,
       .protocols = with_thermometer},
      {.name = "the drive reads too hot for 8 ms",
       .begin = hot(0.008),
       .watched_cycles = 500,
       .protocols = with_thermometer},
      {.name = "commands reach no drive any more", .begin = commands_lost, .most_cycles = 4},
      {.name = "motor and controller silent at once",
       .begin = motor_and_controller_silent,
       .most_cycles = 4},
      {.name = "drive error while the controller is silent",
       .begin = drive_error_while_the_controller_is_silent,
       .most_cycles = 2},
      {.name = "0.3 kg more at the tip", .begin = payload(0.3), .watched_cycles = 500},
      {.name = "first joint's sign wrong",
       .stored = [](Robot* robot) { robot->joints[0].drive.sign *= -1.0; },
       .watched_cycles = kFromStart},
      {.name = "first two joints' identifiers swapped",
       .stored = swap_first_two,
       .watched_cycles = kFromStart},
      {.name = "first joint's angle off by a turn",
       .stored = [](Robot* robot) { robot->joints[0].drive.offset_rad += kTurn_rad; },
       .watched_cycles = kFromStart},
  };
  for (const int bits : {16, 31, 32}) {  // at 1 kHz after 66 s, 24.9 days, 49.7 days
    all.push_back({.name = "the count of cycles passes 2^" + std::to_string(bits),
                   .watched_cycles = 500,
                   .passes = std::int64_t{1} << bits});
  }
  for (Fault& fault : all) fault.place = Place::kFeedback;
  return all;
}

}  // namespace limber::faults
