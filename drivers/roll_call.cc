#include "drivers/roll_call.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "common/clock.h"
#include "drivers/families/drive_family.h"
#include "drivers/motor_view.h"

namespace limber {
namespace {

constexpr std::int64_t kAskAgain_ns = 100'000'000;
constexpr std::int64_t kStragglers_ns = 20'000'000;

class Roll {
 public:
  Roll(const Robot& robot, std::span<CanBus* const> buses)
      : robot_(robot), buses_(buses), here_(static_cast<std::size_t>(robot.motors()), false) {
    for (const JointConfig& joint : robot.joints) {
      for (int motor = 0; motor < joint.motors(); ++motor) add(motor_view(joint, motor));
    }
  }

  bool complete() const {
    return std::all_of(here_.begin(), here_.end(), [](bool here) { return here; });
  }

  void ask() {
    for (std::size_t i = 0; i < here_.size(); ++i) {
      if (here_[i]) continue;
      const auto bus = static_cast<std::size_t>(motors_[i].drive.bus);
      buses_[bus]->send(families_[i]->presence_request());
    }
  }

  void listen_until(std::int64_t deadline_ns) {
    do {
      for (std::size_t b = 0; b < buses_.size(); ++b) {
        CanFrame frame;
        while (buses_[b]->receive(std::span(&frame, 1)) == 1) note(static_cast<int>(b), frame);
      }
    } while (!complete() && wait_readable(buses_, deadline_ns));
  }

  /// Answers to questions that were asked twice must not be taken for something else later.
  void drop_stragglers() {
    const std::int64_t end_ns = monotonic_ns() + kStragglers_ns;
    CanFrame frame;
    while (wait_readable(buses_, end_ns)) {
      for (CanBus* bus : buses_) {
        while (bus->receive(std::span(&frame, 1)) == 1) {
        }
      }
    }
  }

  std::string missing() const {
    std::string names;
    for (std::size_t i = 0; i < here_.size(); ++i) {
      if (here_[i]) continue;
      const JointConfig& joint = motors_[i];
      const BusConfig& bus = robot_.buses[static_cast<std::size_t>(joint.drive.bus)];
      names += fmt::format("{}{} (id 0x{:X} on {})", names.empty() ? "" : ", ", joint.name,
                           joint.drive.command_id, bus.can);
    }
    return names;
  }

 private:
  void add(const JointConfig& motor) {
    const bool fd = robot_.buses[static_cast<std::size_t>(motor.drive.bus)].fd;
    families_.push_back(make_drive_family(motor, fd, 1.0 / robot_.rate_hz));
    motors_.push_back(motor);
  }
  void note(int bus, const CanFrame& frame) {
    for (std::size_t i = 0; i < here_.size(); ++i) {
      if (motors_[i].drive.bus == bus && families_[i]->is_mine(frame)) here_[i] = true;
    }
  }

  const Robot& robot_;
  std::span<CanBus* const> buses_;
  std::vector<JointConfig> motors_;
  std::vector<std::unique_ptr<DriveFamily>> families_;
  std::vector<bool> here_;
};

}  // namespace

std::string call_roll(const Robot& robot, std::span<CanBus* const> buses, double patience_s,
                      const volatile std::sig_atomic_t& stop) {
  Roll roll(robot, buses);
  const std::int64_t end_ns = monotonic_ns() + static_cast<std::int64_t>(patience_s * 1e9);
  while (!roll.complete() && stop == 0 && monotonic_ns() < end_ns) {
    roll.ask();
    roll.listen_until(monotonic_ns() + kAskAgain_ns);
  }
  roll.drop_stragglers();
  return roll.missing();
}

}  // namespace limber
