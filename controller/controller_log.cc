#include "controller/controller_log.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <limber/joint_state_t.hpp>

#include "common/problem_text.h"
#include "controller/modes/supervisor.h"
#include "lcmtypes/mode_words.h"

namespace limber {
namespace {

constexpr std::array kKindNames = {"mode", "goal", "gains", "hand", "stream", "overlay"};

template <typename Names>
const char* name_in(const Names& names, int index) {
  const auto i = static_cast<std::size_t>(index);
  return i < names.size() ? names[i] : "unknown";
}

/// "goal at 1.250 s", "mode hold at 1.250 s".
std::string requested(const request_answer_t& answer) {
  std::string what = name_in(kKindNames, answer.kind);
  if (answer.kind == request_answer_t::KIND_MODE)
    what += std::string(" ") + name_in(kModeRequestWords, answer.what);
  return fmt::format("{} at {:.3f} s", what, 1e-9 * static_cast<double>(answer.time_ns));
}

}  // namespace

request_answer_t answer_to(const RequestOutcome& outcome, std::int64_t time_ns) {
  request_answer_t answer;
  answer.time_ns = time_ns;
  answer.client = outcome.client;
  answer.seq = outcome.seq;
  answer.kind = outcome.kind;
  answer.what = outcome.what;
  answer.accepted = outcome.refusal ? 0 : 1;
  answer.code = outcome.refusal.code;
  const char* text = outcome.refusal ? outcome.refusal.reason : outcome.refusal.warning;
  answer.reason = text != nullptr ? text : "";
  return answer;
}

void ControllerLog::note(const controller_status_t& status, std::int8_t driver_fault) {
  if (status.mode == mode_ && status.reason == reason_) return;
  const bool caused = status.reason != controller_status_t::REASON_NONE && status.reason != reason_;
  const auto joint = static_cast<std::size_t>(status.reason_joint);
  const std::string where = joint < joints_.size() ? joints_[joint] : "";
  mode_ = status.mode;
  reason_ = status.reason;
  const std::string mode = std::string("mode ") + name_in(controller::kModeNames, mode_);
  if (!caused) return spdlog::info(mode);
  const Problem* problem = find_problem(problems::kController, reason_);
  const bool wanted = reason_ == controller_status_t::REASON_DRIVER_FAULT &&
                      driver_fault == joint_state_t::FAULT_REQUESTED;
  if (mode_ == controller_status_t::MODE_FAULT && problem != nullptr && !wanted)
    keep(black_box_, problem->code);
  const std::string line = mode + ": " + problem_text(problems::kController, reason_, where, "");
  // Somebody knows of it already: who stopped the arm, or who reads what the driver told.
  if (reason_ == controller_status_t::REASON_STOP_REQUESTED ||
      reason_ == controller_status_t::REASON_DRIVER_FAULT) {
    spdlog::info(line);
  } else {
    spdlog::warn("warning: {}", line);
  }
}

void ControllerLog::note(const controller_status_t& status, const joint_state_t& state) {
  note(status, state.fault);
  const std::optional<InitWatch::Finding> found = init_.note(status.mode, state);
  if (!found) return;
  const auto joint = static_cast<std::size_t>(found->joint);
  spdlog::warn(
      "warning: not ready after {:.3g} s: {} was late in {:.0f} % of the cycles, and {} states in "
      "a "
      "row with every reply in time are needed; check its cable and the bus's errors, choose a "
      "lower rate_hz or a longer reply_window_s",
      found->waited_s, joint < joints_.size() ? joints_[joint] : "a joint", 100.0 * found->share,
      controller::Supervisor::kSteadyStates);
}

void ControllerLog::note(const request_answer_t& answer) {
  if (answer.accepted != 0) {
    if (!answer.reason.empty()) spdlog::warn("warning: {}: {}", requested(answer), answer.reason);
    return;
  }
  spdlog::warn("warning: {} refused: {}", requested(answer),
               refusal_text(answer.code, answer.reason));
}

}  // namespace limber
