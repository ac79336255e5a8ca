// Faults of the bus, and of drives as the bus shows them.
#include <algorithm>
#include <random>

#include "drivers/can/lockstep_frame.h"
#include "drivers/protocols/canopen_sdo.h"
#include "drivers/protocols/cia402.h"
#include "drivers/protocols/mit.h"
#include "drivers/protocols/robstride.h"
#include "qa/faults/fault_table.h"
#include "qa/faults/state_change.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber::faults {
namespace {

using Frames = std::vector<CanFrame>;

/// Of four drives on a bus of iiwa14: 22 objects each, one every 20 cycles, and the changed one
/// once more. desktop2r has five registers of two drives: 240.
constexpr int kLastSetting = 1840;
constexpr auto kTimeoutParameter = static_cast<std::uint16_t>(robstride::Parameter::kTimeout);

std::function<void(FaultStage*)> replies(const TamperedBus::Change& change) {
  return [change](FaultStage* stage) { stage->change_replies(change); };
}

/// The first `count` replies are lost.
std::function<void(FaultStage*)> lose(int count) {
  return [count](FaultStage* stage) {
    const auto frames = static_cast<int>(stage->joint().drive.frames.replies.size());
    stage->change_replies([left = count * frames](const CanFrame& frame, Frames* instead) mutable {
      if (left-- <= 0) instead->push_back(frame);
    });
  };
}

/// Each reply is lost with this probability, of several frames by one of them.
std::function<void(FaultStage*)> lose_share(double probability) {
  return [probability](FaultStage* stage) {
    const auto frames = static_cast<double>(stage->joint().drive.frames.replies.size());
    stage->change_replies([share = probability / frames, random = std::minstd_rand(7)](
                              const CanFrame& frame, Frames* instead) mutable {
      if (std::uniform_real_distribution<>(0.0, 1.0)(random) >= share) instead->push_back(frame);
    });
  };
}

/// The motion in the drive's replies is changed, in the first `count` or, below 0, in all.
std::function<void(FaultStage*)> moved(const MotionChange& change, int count) {
  return [change, count](FaultStage* stage) {
    const auto frames = static_cast<int>(stage->joint().drive.frames.replies.size());
    stage->change_replies([=, left = count * frames](const CanFrame& frame,
                                                     Frames* instead) mutable {
      const bool now = count < 0 || left-- > 0;
      instead->push_back(now ? with_motion(frame, stage->joint(), stage->bus_config().fd, change)
                             : frame);
    });
  };
}

/// The replies of the cycle before come in front of the true ones.
std::function<void(FaultStage*)> replay() {
  return replies([last = Frames()](const CanFrame& frame, Frames* instead) mutable {
    const auto same = std::ranges::find(last, frame.id, &CanFrame::id);
    if (same == last.end()) {
      last.push_back(frame);
      return instead->push_back(frame);
    }
    CanFrame old = *same;
    old.timestamp_ns = frame.timestamp_ns;
    instead->insert(instead->end(), {old, frame});
    *same = frame;
  });
}

void drive_error(FaultStage* stage) {
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_FAULT;
  event.fault = scenario_event_t::FAULT_DRIVE_ERROR;
  stage->simulator().event(event);
}

/// Another master sends the drive a command of no torque in every cycle.
void foreign_master(FaultStage* stage) {
  stage->set_each_cycle([stage] {
    CanFrame frame;
    DriveCommand sent;
    if (stage->family().codec->command({}, {}, &frame, &sent)) stage->send_from_outside(frame);
  });
}

/// The drive takes its next command for a disable.
void disabled(FaultStage* stage) {
  const DriveConfig& drive = stage->joint().drive;
  stage->bus().replace_sent(
      [&drive](const CanFrame& frame) { return has_kind(frame, drive, drive.command_id); },
      stage->family().codec->disable());
}

void foreign_disable(FaultStage* stage) {
  stage->send_from_outside(stage->family().codec->disable());
}

std::uint16_t number_of(const DriveConfig& drive) {
  return static_cast<std::uint16_t>(drive.command_id);
}

std::uint8_t robstride_number(const DriveConfig& drive) {
  return static_cast<std::uint8_t>(drive.command_id);
}

bool is_robstride(const DriveConfig& drive) { return drive.protocol->word == "robstride"; }

bool is_damiao(const DriveConfig& drive) { return drive.protocol->word == "damiao_mit"; }

/// Damiao: PMAX; RobStride: the time-out; CiA 402: the mode, 6060h.
void foreign_setting(FaultStage* stage) {
  const DriveConfig& drive = stage->joint().drive;
  stage->send_from_outside(
      is_robstride(drive) ? robstride::encode_write(robstride_number(drive), kTimeoutParameter, 0)
      : is_damiao(drive)
          ? mit::encode_register_write(number_of(drive), mit::Register::kPositionRange,
                                       mit::float_bits(6.0F), false)
          : canopen::encode_sdo_write(cia402::kMode, 1, canopen::node_of(drive.command_id)));
}

/// What the maker's tool of a Damiao drive writes over its own wire: position and velocity.
void mode_past_the_bus(FaultStage* stage) {
  stage->simulator().tell_past_the_bus(
      0, mit::encode_register_write(number_of(stage->joint().drive), mit::Register::kControlMode, 2,
                                    stage->bus_config().fd));
}

/// Damiao: TIMEOUT; RobStride: the time-out; CiA 402: the event timer of RPDO1.
void watchdog_off_past_the_bus(FaultStage* stage) {
  const DriveConfig& drive = stage->joint().drive;
  const auto timer = canopen::pdo_event_timer_ms(canopen::kRpdoCommunication);
  stage->simulator().tell_past_the_bus(
      0,
      is_robstride(drive) ? robstride::encode_write(robstride_number(drive), kTimeoutParameter, 0)
      : is_damiao(drive)  ? mit::encode_register_write(number_of(drive), mit::Register::kTimeout, 0,
                                                       stage->bus_config().fd)
                         : canopen::encode_sdo_write(timer, 0, canopen::node_of(drive.command_id)));
}

/// The velocity is wrong by half of the joint's limit, so that no limit notices.
void false_velocity(FaultStage* stage) {
  moved({0.0, 0.5 * stage->joint().velocity_limit}, -1)(stage);
}

void other_devices(FaultStage* stage) {
  stage->set_each_cycle([stage] {
    CanFrame frame;
    frame.id = 0x6F3;
    frame.length = 8;
    stage->send_from_outside(frame);
  });
}

void all_silent(FaultStage* stage) {
  for (TamperedBus* bus : stage->buses()) {
    bus->set_change([](const CanFrame& frame, Frames* instead) {
      if (lockstep::is_tock(frame)) instead->push_back(frame);
    });
  }
}

}  // namespace

std::vector<Fault> bus_faults() {
  const std::vector<std::string_view> only_damiao = {"damiao_mit"};
  return {
      {.name = "one motor silent", .begin = replies([](auto&, auto*) {}), .most_cycles = 3},
      {.name = "all motors silent", .begin = all_silent, .most_cycles = 3},
      {.name = "one reply lost", .begin = lose(1)},
      {.name = "two replies lost in a row", .begin = lose(2)},
      {.name = "three replies lost in a row", .begin = lose(3), .most_cycles = 3},
      {.name = "0.5 % of the replies lost", .begin = lose_share(0.005), .watched_cycles = 1000},
      {.name = "5 % of the replies lost",
       .begin = lose_share(0.05),
       .most_cycles = 1000,
       .watched_cycles = 1000},
      {.name = "replies under another identifier",
       .begin = replies([](CanFrame frame, auto* instead) {
         frame.id ^= 0x400;
         instead->push_back(frame);
       }),
       .most_cycles = 3},
      {.name = "replies with another motor's id in the data",
       .begin = replies([](CanFrame frame, auto* instead) {
         frame.data[0] ^= 0x8;
         instead->push_back(frame);
       }),
       .most_cycles = 3,
       .protocols = {"damiao_mit", "cubemars"}},
      {.name = "replies of four bytes",
       .begin = replies([](CanFrame frame, auto* instead) {
         frame.length = 4;
         instead->push_back(frame);
       }),
       .most_cycles = 3},
      {.name = "empty replies",
       .begin = replies([](CanFrame frame, auto* instead) {
         frame.length = 0;
         instead->push_back(frame);
       }),
       .most_cycles = 3},
      {.name = "replies after the end of their cycle",
       .begin =
           [](FaultStage* stage) {
             stage->change_replies(
                 [stage](const CanFrame& frame, auto*) { stage->bus().hold(frame); });
           }},
      {.name = "replies of the last cycle in front of the true ones",
       .begin = replay(),
       .most_cycles = 12},
      {.name = "two motors with one identifier",
       .begin =
           [](FaultStage* stage) {
             stage->change_replies([stage](const CanFrame& frame, auto* instead) {
               instead->push_back(frame);
               instead->push_back(
                   with_motion(frame, stage->joint(), stage->bus_config().fd, {0.3, 0.0}));
             });
           },
       .most_cycles = 12},
      {.name = "the angle jumps by 0.5 rad and stays",
       .begin = moved({0.5, 0.0}, -1),
       .most_cycles = 4},
      {.name = "the angle jumps by 0.5 rad for one cycle", .begin = moved({0.5, 0.0}, 1)},
      {.name = "the speed reads 1000 rad/s more",
       .begin = moved({0.0, 1000.0}, -1),
       .most_cycles = 4},
      {.name = "the velocity is wrong by half of the joint's limit",
       .begin = false_velocity,
       .most_cycles = 400,
       .watched_cycles = 400},
      {.name = "the drive reports an error", .begin = drive_error, .most_cycles = 2},
      {.name = "the drive disables itself",
       .begin = disabled,
       .most_cycles = 2,
       .protocols = {"damiao_mit", "moteus", "cia402", "robstride", "myactuator"}},
      {.name = "the drive disables itself, and its replies do not tell",
       .begin = disabled,
       .most_cycles = 20,
       .protocols = {"cubemars", "odrive"}},
      {.name = "another program disables the drive", .begin = foreign_disable, .most_cycles = 1},
      {.name = "another program commands the drive", .begin = foreign_master, .most_cycles = 1},
      {.name = "another program writes the drive's settings",
       .begin = foreign_setting,
       .most_cycles = 1,
       .protocols = {"damiao_mit", "cia402", "robstride"}},
      {.name = "the drive's control mode is changed past the bus",
       .begin = mode_past_the_bus,
       .most_cycles = 240,
       .watched_cycles = 300,
       .protocols = only_damiao},
      {.name = "the drive's watchdog is switched off past the bus",
       .begin = watchdog_off_past_the_bus,
       .most_cycles = kLastSetting,
       .watched_cycles = kLastSetting + 100,
       .protocols = {"damiao_mit", "cia402", "robstride"}},
      {.name = "frames of other devices", .begin = other_devices},
      {.name = "bus-off",
       .begin = [](FaultStage* stage) { stage->bus().set_bus_off(); },
       .most_cycles = 1},
      {.name = "interface down or gone",
       .begin = [](FaultStage* stage) { stage->bus().set_link_down(); },
       .most_cycles = 1},
      {.name = "transmit queue full",
       .begin = [](FaultStage* stage) { stage->bus().refuse_sends(); },
       .most_cycles = 3},
      {.name = "the drive has other ranges, gains or rated torque stored",
       .stored =
           [](Robot* robot) {
             DriveConfig* drive = &robot->joints[0].drive;
             drive->range.position_rad *= 1.005;
             drive->range.kp_Nm_per_rad *= 1.05;
             drive->rated_torque_Nm *= 1.005;
           },
       .protocols = {"damiao_mit", "moteus", "cia402"}},  // a RobStride drive has no such registers
  };
}

}  // namespace limber::faults
