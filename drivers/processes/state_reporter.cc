#include "drivers/processes/state_reporter.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <chrono>
#include <limber/driver_status_t.hpp>

#include "common/pace_text.h"
#include "common/problem_text.h"
#include "common/tell.h"
#include "drivers/drives_text.h"

namespace limber {
namespace {

constexpr auto kRound = std::chrono::milliseconds(20);
constexpr int kRoundsPerSecond = std::chrono::seconds(1) / kRound;

int fault_of(std::uint64_t packed) noexcept { return static_cast<int>(packed >> 8 & 0xFF); }

}  // namespace

StateReporter::StateReporter(std::vector<std::string> joints) : joints_(std::move(joints)) {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    std::uint64_t reported = kNothing;
    std::array<DriveWarning, kMaxMotors> warned{};
    bool last_round = false;
    while (!last_round) {
      last_round = stop.stop_requested();
      for (std::size_t k = taken_; k != queued_.load(std::memory_order_acquire);) {
        const std::uint64_t noted = changes_[k % kChanges];
        tell([&] { report_changes(reported, noted); });
        reported = noted;
        taken_.store(++k, std::memory_order_release);
      }
      tell([&] {
        report_stall();
        report_warnings(&warned);
        report_other_controller();
      });
      if (!last_round) std::this_thread::sleep_for(kRound);
    }
  });
}

StateReporter::~StateReporter() = default;

void StateReporter::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void StateReporter::report_changes(std::uint64_t reported, std::uint64_t noted) const {
  const bool first_time = reported == kNothing;
  const int known_fault = first_time ? joint_state_t::FAULT_NONE : fault_of(reported);
  if (first_time || (reported & ~kSensorError) != (noted & ~kSensorError))
    report(noted, known_fault);
  const bool was_lost = !first_time && (reported & kSensorError) != 0;
  const bool lost = (noted & kSensorError) != 0;
  if (lost && !was_lost)
    spdlog::warn("warning: {}",
                 problem_text(problems::kSensor, joint_state_t::SENSOR_ERROR, "", ""));
  if (!lost && was_lost) spdlog::info("tip sensor: back");
}

void StateReporter::report_warnings(std::array<DriveWarning, kMaxMotors>* reported) const {
  for (std::size_t m = 0; m < warnings_.size(); ++m) {
    const DriveWarning now = warnings_[m].load(std::memory_order_acquire);
    const bool differs = now.differs((*reported)[m]);
    (*reported)[m] = now;
    if (differs && warning_text_) {
      const std::string text = warning_text_(static_cast<int>(m), now);
      now.any() ? spdlog::warn("warning: {}", text) : spdlog::info("{}", text);
    }
  }
}

void StateReporter::report_stall() {
  const std::int64_t stall_ns = stall_ns_.exchange(0, std::memory_order_acq_rel);
  if (stall_ns > 0) spdlog::warn("warning: {}", stall_text("limber-driver", stall_ns));
}

void StateReporter::report_other_controller() {
  if (rounds_until_next_ > 0 && --rounds_until_next_ > 0) return;
  const std::int64_t other = other_controller_.load(std::memory_order_acquire);
  if (other == controller_told_) return;
  controller_told_ = other;
  rounds_until_next_ = kRoundsPerSecond;
  const std::string who =
      fmt::format("number {}, and {} has the arm", other, holder_.load(std::memory_order_relaxed));
  spdlog::warn("warning: {}",
               problem_text(problems::kGate, driver_status_t::VERDICT_CONTROLLER, "", who));
}

void StateReporter::report(std::uint64_t packed, int known_fault) const {
  const int state = static_cast<int>(packed & 0xFF);
  const int fault = fault_of(packed);
  const auto joint = static_cast<std::size_t>(packed >> 16 & 0xFF);
  if (known_fault == fault) return spdlog::info(drives_text_again(state, fault));
  const auto detail = static_cast<std::uint16_t>(packed >> 32U);
  const bool named = joint < joints_.size();
  const int of_joint = named ? static_cast<int>(joint) : -1;
  const std::string text = fault_text_ ? fault_text_(fault, of_joint, detail) : "";
  spdlog::info(drives_text(state, fault, named ? joints_[joint] : "", text));
  const Problem* problem = find_problem(problems::kDriver, fault);
  const bool wanted = fault == joint_state_t::FAULT_REQUESTED && (packed & kByController) == 0;
  if (problem != nullptr && !wanted && on_fault_) on_fault_(problem->code);
}

}  // namespace limber
