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

/// To the controller.
template <typename Request>
int take(limber_lab* lab, const Request& request,
         Refusal (ArmController::*decide)(const Request&) noexcept) {
  const RequestOutcome outcome = outcome_of(request, (lab->lab.controller().*decide)(request));
  lab->answer = answer_to(outcome, lab->lab.time_ns());
  return outcome.refusal ? fail(lab, LIMBER_LAB_REFUSED, lab->answer->reason) : LIMBER_LAB_DONE;
}

/// A change of the simulated world.
template <typename Event>
int take(limber_lab* lab, const Event& event, bool (Simulator::*change)(const Event&) noexcept) {
  if ((lab->lab.simulator().*change)(event)) return LIMBER_LAB_DONE;
  return fail(lab, LIMBER_LAB_REFUSED, "values out of range, no such link, or no free slot");
}

template <typename Owner, typename Answer, typename Message>
Message message_of(Answer (Owner::*)(const Message&) noexcept);

template <auto member>
int request(limber_lab* lab, const std::uint8_t* data, std::size_t size) {
  decltype(message_of(member)) message{};
  if (!decode_message(data, size, &message))
    return fail(lab, LIMBER_LAB_MALFORMED, "not a message of the channel's type");
  return take(lab, message, member);
}

using Take = int (*)(limber_lab*, const std::uint8_t*, std::size_t);
constexpr std::pair<const char*, Take> kRequests[] = {
    {channels::kModeRequest, request<&ArmController::on_mode>},
    {channels::kComplianceGoal, request<&ArmController::on_goal>},
    {channels::kComplianceGains, request<&ArmController::on_gains>},
    {channels::kTargetStream, request<&ArmController::on_stream>},
    {channels::kTorqueOverlay, request<&ArmController::on_overlay>},
    {channels::kHandGoal, request<&ArmController::on_hand>},
    {channels::kPush, request<&Simulator::push>},
    {channels::kScenarioEvent, request<&Simulator::event>},
    {channels::kWorkpiece, request<&Simulator::workpiece>},
};

// --- messages ------------------------------------------------------------------------------------

/// `newest`: the message, or null.
template <auto newest>
int message(limber_lab* lab, std::uint8_t* out, std::size_t room) {
  const auto* found = newest(lab);
  if (found == nullptr) return fail(lab, LIMBER_LAB_NONE, "there is no such message yet");
  const int size = found->getEncodedSize();
  if (static_cast<std::size_t>(size) > room)
    return fail(lab, LIMBER_LAB_ROOM, fmt::format("the message has {} bytes", size));
  return found->encode(out, 0, size);
}

using At = limber_lab*;
using Give = int (*)(limber_lab*, std::uint8_t*, std::size_t);
constexpr std::pair<const char*, Give> kMessages[] = {
    {channels::kJointState, message<[](At at) { return &at->lab.state(); }>},
    {channels::kJointTorque, message<[](At at) { return &at->lab.torque(); }>},
    {channels::kSimTruth, message<[](At at) { return &at->lab.truth(); }>},
    {channels::kBlockTruth, message<[](At at) { return at->lab.simulator().block_truth(); }>},
    {channels::kControllerStatus, message<[](At at) { return &at->lab.controller_status(); }>},
    {channels::kDriverStatus, message<[](At at) { return &at->lab.driver_status(); }>},
    {channels::kRobotInfo, message<[](At at) { return &at->lab.controller().robot_info(); }>},
    {channels::kHandState, message<[](At at) { return at->lab.controller().hand_state(); }>},
    {channels::kHandTruth, message<[](At at) { return at->lab.simulator().hand_truth(); }>},
    {channels::kRequestAnswer, message<[](At at) { return at->answer ? &*at->answer : nullptr; }>},
};

/// Calls what belongs to the channel; a code of what it throws.
template <typename Rows, typename Call>
int of_channel(limber_lab* lab, const Rows& rows, const char* channel, Call call) noexcept {
  try {
    for (const auto& [name, function] : rows) {
      if (std::strcmp(name, channel) == 0) return call(function);
    }
    return fail(lab, LIMBER_LAB_CHANNEL, fmt::format("no such channel here: '{}'", channel));
  } catch (const std::exception& error) {
    return fail(lab, LIMBER_LAB_MALFORMED, error.what());
  }
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
  return of_channel(lab, kRequests, channel, [&](Take take) { return take(lab, data, size); });
}

int limber_lab_message(limber_lab* lab, const char* channel, uint8_t* out, size_t room) {
  return of_channel(lab, kMessages, channel, [&](Give give) {
    if (lab->lab.cycles() == 0) return fail(lab, LIMBER_LAB_NONE, "no cycle has been yet");
    return give(lab, out, room);
  });
}

int64_t limber_lab_time_ns(const limber_lab* lab) { return lab->lab.time_ns(); }

int64_t limber_lab_period_ns(const limber_lab* lab) {
  return std::llround(1e9 / lab->robot.robot.rate_hz);
}

const char* limber_lab_error(const limber_lab* lab) { return lab->error.c_str(); }
