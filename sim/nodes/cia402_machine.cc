#include "sim/nodes/cia402_machine.h"

namespace limber::sim {
namespace {

using cia402::Command;
using cia402::State;

constexpr std::int64_t kFaultReaction_ns = 1'000'000;
constexpr int kFirstStaying = 5;  // quick stop options

}  // namespace

void Cia402Machine::on_controlword(std::uint16_t controlword, int quick_stop_option,
                                   bool reset_allowed) noexcept {
  const Command command = cia402::command_of(controlword, controlword_);
  controlword_ = controlword;
  if (command == Command::kFaultReset && !reset_allowed) return;
  if (command == Command::kQuickStop) return quick_stop(quick_stop_option);
  state_ = cia402::next_state(state_, command, quick_stop_option >= kFirstStaying);
}

void Cia402Machine::quick_stop(int quick_stop_option) noexcept {
  state_ = cia402::next_state(state_, Command::kQuickStop, false);
  if (state_ == State::kQuickStopActive && quick_stop_option == 0) disable_voltage();
}

void Cia402Machine::disable_voltage() noexcept {
  state_ = cia402::next_state(state_, Command::kDisableVoltage, false);
}

void Cia402Machine::fail(std::int64_t now_ns) noexcept {
  if (failed()) return;
  state_ = State::kFaultReactionActive;
  failed_ns_ = now_ns;
}

void Cia402Machine::update(std::int64_t now_ns, bool standing, int quick_stop_option) noexcept {
  if (state_ == State::kNotReady) state_ = State::kSwitchOnDisabled;
  if (state_ == State::kFaultReactionActive && now_ns - failed_ns_ >= kFaultReaction_ns)
    state_ = State::kFault;
  if (state_ == State::kQuickStopActive && standing && quick_stop_option < kFirstStaying)
    disable_voltage();
}

}  // namespace limber::sim
