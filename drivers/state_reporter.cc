#include "drivers/state_reporter.h"

#include <spdlog/spdlog.h>

#include <array>
#include <chrono>

namespace limber {
namespace {

constexpr std::array kStateNames = {"configuring", "off",  "enabling", "on",
                                    "hold",        "damp", "fault"};
constexpr std::array kFaultNames = {"none",           "controller lost", "commands refused",
                                    "replies lost",   "drive error",     "configuration wrong",
                                    "position limit", "velocity limit",  "bus lost",
                                    "overruns",       "requested"};
constexpr std::uint32_t kNothing = 0xFFFFFFFF;

template <typename Names>
std::string name_in(const Names& names, int index) {
  const auto i = static_cast<std::size_t>(index);
  return i < names.size() ? names[i] : "unknown";
}

}  // namespace

std::string drive_state_name(int drive_state) { return name_in(kStateNames, drive_state); }
std::string fault_name(int fault) { return name_in(kFaultNames, fault); }

StateReporter::StateReporter(std::vector<std::string> joints)
    : joints_(std::move(joints)), noted_(kNothing) {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    std::uint32_t told = kNothing;
    bool last_look = false;
    while (!last_look) {
      last_look = stop.stop_requested();
      const std::uint32_t noted = noted_.load(std::memory_order_relaxed);
      if (noted != told) report_changes(told, noted);
      told = noted;
      if (!last_look) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
}

StateReporter::~StateReporter() = default;

void StateReporter::report_changes(std::uint32_t told, std::uint32_t noted) const {
  const bool nothing_told = told == kNothing;
  if (nothing_told || (told & ~kSensorError) != (noted & ~kSensorError)) report(noted);
  const bool was_lost = !nothing_told && (told & kSensorError) != 0;
  const bool lost = (noted & kSensorError) != 0;
  if (lost && !was_lost) spdlog::warn("tip sensor: does not answer, or is beyond its range");
  if (!lost && was_lost) spdlog::info("tip sensor: back");
}

void StateReporter::report(std::uint32_t packed) const {
  const int state = static_cast<int>(packed & 0xFF);
  const int fault = static_cast<int>(packed >> 8 & 0xFF);
  const auto joint = static_cast<std::size_t>(packed >> 16 & 0xFF);
  if (fault == joint_state_t::FAULT_NONE) {
    spdlog::info("drives: {}", drive_state_name(state));
    return;
  }
  const std::string where = joint < joints_.size() ? " (" + joints_[joint] + ")" : "";
  spdlog::warn("drives: {}, because of: {}{}", drive_state_name(state), fault_name(fault), where);
}

}  // namespace limber
