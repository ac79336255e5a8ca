#include "lab/lab_interface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "common/decode_message.h"
#include "controller/controller_log.h"
#include "controller/laws/registry.h"
#include "lab/lab.h"
#include "lcmtypes/channels.h"
#include "scenarios/loader/scenario_yaml.h"

using namespace limber;

/// Robot and scenario outlive the lab that is made of them.
struct limber_lab {
  explicit limber_lab(const YamlMap& yaml)
      : robot(load_robot(scenario_robot(yaml))),
        scenario(load_scenario(yaml, robot, &controller::law_catalog())),
        lab(robot, scenario) {}

  LoadedRobot robot;
  Scenario scenario;
  Lab lab;
  std::optional<request_answer_t> answer;  ///< to the last request that was sent
  std::string error;
};

namespace {

int fail(limber_lab* lab, int code, const std::string& why) {
  lab->error = why;
  return code;
}

// --- requests ------------------------------------------------------------------------------------

/// A request of this type to the controller.
template <typename Request, Refusal (ArmController::*decide)(const Request&) noexcept>
int ask(limber_lab* lab, const Request& request) {
  const RequestOutcome outcome = outcome_of(request, (lab->lab.controller().*decide)(request));
  lab->answer = answer_to(outcome, lab->lab.time_ns());
  return outcome.refusal ? fail(lab, LIMBER_LAB_REFUSED, lab->answer->reason) : LIMBER_LAB_DONE;
}

/// A change of the simulated world.
template <typename Event, bool (Simulator::*change)(const Event&) noexcept>
int befall(limber_lab* lab, const Event& event) {
  return (lab->lab.simulator().*change)(event)
             ? LIMBER_LAB_DONE
             : fail(lab, LIMBER_LAB_REFUSED, "values out of range, no such link, or no free slot");
}

template <typename Message, int (*take)(limber_lab*, const Message&)>
int decoded(limber_lab* lab, const char* channel, const std::uint8_t* data, std::size_t size) {
  Message message{};
  if (!decode_message(data, size, &message))
    return fail(lab, LIMBER_LAB_MALFORMED, fmt::format("{}: not a message of its type", channel));
  return take(lab, message);
}

using Controller = ArmController;
using Take = int (*)(limber_lab*, const char*, const std::uint8_t*, std::size_t);
constexpr std::pair<const char*, Take> kRequests[] = {
    {channels::kModeRequest, decoded<mode_request_t, ask<mode_request_t, &Controller::on_mode>>},
    {channels::kComplianceGoal,
     decoded<compliance_goal_t, ask<compliance_goal_t, &Controller::on_goal>>},
    {channels::kComplianceGains,
     decoded<compliance_gains_t, ask<compliance_gains_t, &Controller::on_gains>>},
    {channels::kTargetStream,
     decoded<target_stream_t, ask<target_stream_t, &Controller::on_stream>>},
    {channels::kTorqueOverlay,
     decoded<torque_overlay_t, ask<torque_overlay_t, &Controller::on_overlay>>},
    {channels::kPush, decoded<push_t, befall<push_t, &Simulator::push>>},
    {channels::kScenarioEvent,
     decoded<scenario_event_t, befall<scenario_event_t, &Simulator::event>>},
    {channels::kWorkpiece, decoded<workpiece_t, befall<workpiece_t, &Simulator::workpiece>>},
};

// --- messages ------------------------------------------------------------------------------------

template <typename Message>
int encoded(limber_lab* lab, const Message& message, std::uint8_t* out, std::size_t room) {
  const int size = message.getEncodedSize();
  if (static_cast<std::size_t>(size) > room)
    return fail(lab, LIMBER_LAB_ROOM, fmt::format("the message has {} bytes", size));
  return message.encode(out, 0, size);
}

using Give = int (*)(limber_lab*, std::uint8_t*, std::size_t);
constexpr std::pair<const char*, Give> kMessages[] = {
    {channels::kJointState,
     [](limber_lab* at, std::uint8_t* out, std::size_t room) {
       return encoded(at, at->lab.state(), out, room);
     }},
    {channels::kJointTorque,
     [](limber_lab* at, std::uint8_t* out, std::size_t room) {
       return encoded(at, at->lab.torque(), out, room);
     }},
    {channels::kSimTruth,
     [](limber_lab* at, std::uint8_t* out, std::size_t room) {
       return encoded(at, at->lab.truth(), out, room);
     }},
    {channels::kControllerStatus,
     [](limber_lab* at, std::uint8_t* out, std::size_t room) {
       return encoded(at, at->lab.controller_status(), out, room);
     }},
    {channels::kDriverStatus,
     [](limber_lab* at, std::uint8_t* out, std::size_t room) {
       return encoded(at, at->lab.driver_status(), out, room);
     }},
    {channels::kRobotInfo,
     [](limber_lab* at, std::uint8_t* out, std::size_t room) {
       return encoded(at, at->lab.controller().robot_info(), out, room);
     }},
    {channels::kBlockTruth,
     [](limber_lab* at, std::uint8_t* out, std::size_t room) {
       const block_truth_t* block = at->lab.simulator().block_truth();
       return block != nullptr ? encoded(at, *block, out, room)
                               : fail(at, LIMBER_LAB_NONE, "no block is on a table");
     }},
    {channels::kRequestAnswer,
     [](limber_lab* at, std::uint8_t* out, std::size_t room) {
       return at->answer ? encoded(at, *at->answer, out, room)
                         : fail(at, LIMBER_LAB_NONE, "no request was sent yet");
     }},
};

/// What `call` returns, or the code of what it throws.
template <typename Call>
int guarded(limber_lab* lab, int otherwise, Call call) noexcept {
  try {
    return call();
  } catch (const std::exception& error) {
    try {
      lab->error = error.what();
    } catch (const std::exception&) {  // no memory for it
    }
    return otherwise;
  }
}

/// Calls what belongs to the channel.
template <typename Rows, typename Call>
int of_channel(limber_lab* lab, const Rows& rows, const char* channel, Call call) {
  for (const auto& [name, function] : rows) {
    if (std::strcmp(name, channel) == 0) return call(function);
  }
  return fail(lab, LIMBER_LAB_CHANNEL, fmt::format("no such channel here: '{}'", channel));
}

}  // namespace

limber_lab* limber_lab_open(const char* scenario, const char* name, char* problem, size_t room) {
  try {
    const YamlMap yaml = YamlMap::from_text(scenario, name);
    if (!scenario_laws(yaml).empty())
      yaml.refuse("law_file", "a lab in a program runs limber's own laws");
    return new limber_lab(yaml);
  } catch (const std::exception& error) {
    if (room == 0) return nullptr;
    const std::size_t size = std::min(room - 1, std::strlen(error.what()));
    std::memcpy(problem, error.what(), size);
    problem[size] = 0;
    return nullptr;
  }
}

void limber_lab_close(limber_lab* lab) { delete lab; }

void limber_lab_step(limber_lab* lab, int64_t cycles) {
  for (; cycles > 0; --cycles) lab->lab.step();
}

int limber_lab_send(limber_lab* lab, const char* channel, const uint8_t* data, size_t size) {
  return guarded(lab, LIMBER_LAB_MALFORMED, [&] {
    return of_channel(lab, kRequests, channel,
                      [&](Take take) { return take(lab, channel, data, size); });
  });
}

int limber_lab_message(limber_lab* lab, const char* channel, uint8_t* out, size_t room) {
  return guarded(lab, LIMBER_LAB_NONE, [&] {
    return of_channel(lab, kMessages, channel, [&](Give give) {
      if (lab->lab.cycles() == 0) return fail(lab, LIMBER_LAB_NONE, "no cycle has been yet");
      return give(lab, out, room);
    });
  });
}

int64_t limber_lab_time_ns(const limber_lab* lab) { return lab->lab.time_ns(); }

int64_t limber_lab_period_ns(const limber_lab* lab) {
  return std::llround(1e9 / lab->robot.robot.rate_hz);
}

const char* limber_lab_error(const limber_lab* lab) { return lab->error.c_str(); }
