#include "drivers/drive/drive_discovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "common/clock.h"
#include "drivers/can/lockstep_frame.h"
#include "drivers/drive/motor_view.h"
#include "drivers/families/drive_family.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

constexpr std::int64_t kRepeat_ns = 100'000'000;
constexpr std::int64_t kListen_ns = 250'000'000;
constexpr std::int64_t kTell_ns = 1'500'000'000;
constexpr std::int64_t kStragglers_ns = 20'000'000;
constexpr std::int64_t kTwin_ns = 3'000'000;  // a second answer comes within this after the first
constexpr int kTwinRounds = 2;                // a straggler is no twin

class Discovery {
 public:
  Discovery(const Robot& robot, std::span<CanBus* const> buses, bool lockstep)
      : robot_(robot),
        buses_(buses),
        lockstep_(lockstep),
        found_(static_cast<std::size_t>(robot.motors()), false) {
    for (const JointConfig& joint : robot.driven()) {
      for (int motor = 0; motor < joint.motors(); ++motor) add(motor_view(joint, motor));
    }
  }

  bool complete() const {
    return std::all_of(found_.begin(), found_.end(), [](bool found) { return found; });
  }

  void send_requests() {
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const std::int64_t now_ns = monotonic_ns();
      if (found_[i] || now_ns < ask_again_ns_[i]) continue;
      const auto bus = static_cast<std::size_t>(motors_[i].drive.bus);
      buses_[bus]->send(families_[i].startup->presence_request());
      ask_again_ns_[i] = now_ns + patience_ns(*families_[i].startup);
    }
    // On a simulated wire time stands still until the first cycle.
    for (CanBus* bus : buses_) {
      if (lockstep_) bus->send(lockstep::tick(lockstep::kStandstill));
    }
  }

  void receive_until(std::int64_t deadline_ns) {
    do {
      for (std::size_t b = 0; b < buses_.size(); ++b) {
        CanFrame frame;
        while (buses_[b]->receive(std::span(&frame, 1)) == 1) mark(static_cast<int>(b), frame);
      }
    } while (!complete() && wait_readable(buses_, deadline_ns));
  }

  /// The first one that arrives until then; nothing is sent.
  std::string foreign_command(std::int64_t deadline_ns) const {
    do {
      for (std::size_t b = 0; b < buses_.size(); ++b) {
        CanFrame frame;
        while (buses_[b]->receive(std::span(&frame, 1)) == 1) {
          std::string names = commanded_by(static_cast<int>(b), frame);
          if (!names.empty()) return names;
        }
      }
    } while (wait_readable(buses_, deadline_ns));
    return "";
  }

  /// Answers to repeated requests must not be taken for replies of the first cycle.
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

  std::size_t size() const { return motors_.size(); }
  const JointConfig& motor(std::size_t i) const { return motors_[i]; }
  /// Its presence is answered as soon as its commands are, not by a server beside the cycle.
  bool prompt(std::size_t i) const {
    CanFrame frame;
    return !families_[i].codec->needs_bus_frame(&frame);
  }

  /// Sends one motor a request and counts its answers until `listen_ns` after the first one;
  /// first_ns: how long that took.
  int answers(std::size_t i, std::int64_t listen_ns, std::int64_t* first_ns) {
    CanBus* bus = buses_[static_cast<std::size_t>(motors_[i].drive.bus)];
    const std::int64_t start_ns = monotonic_ns();
    std::int64_t end_ns = start_ns + std::max(kRepeat_ns, patience_ns(*families_[i].startup));
    int count = 0;
    bus->send(families_[i].startup->presence_request());
    do {
      CanFrame frame;
      while (bus->receive(std::span(&frame, 1)) == 1) {
        if (!families_[i].startup->is_presence(frame)) continue;
        if (++count > 1) continue;
        const std::int64_t now_ns = monotonic_ns();
        *first_ns = (frame.timestamp_ns != 0 ? frame.timestamp_ns : now_ns) - start_ns;
        end_ns = now_ns + listen_ns;
      }
    } while (wait_readable(std::span(&bus, 1), end_ns));
    return count;
  }

  std::string missing() const {
    std::string names;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      if (!found_[i]) list(i, &names);
    }
    for (std::size_t i = 0; i < found_.size(); ++i) {
      if (found_[i] || !wrong_id_[i]) continue;
      names += fmt::format("; {} answers with id 0x{:X} instead of 0x{:X} ({})", motors_[i].name,
                           *wrong_id_[i], motors_[i].drive.reply_id,
                           families_[i].startup->reply_id_setting());
    }
    return names;
  }

  /// Buses on which frames were destroyed.
  std::string disturbed() const {
    std::string text;
    for (std::size_t b = 0; b < buses_.size(); ++b) {
      const std::int64_t errors = buses_[b]->statistics().error_frames;
      if (errors > 0) text += fmt::format("; {} error frames on {}", errors, robot_.buses[b].can);
    }
    return text;
  }

  /// "joint1 (id 0x1 on vcan0), joint2 (id 0x2 on vcan0)"
  void list(std::size_t i, std::string* names) const {
    const JointConfig& joint = motors_[i];
    const BusConfig& bus = robot_.buses[static_cast<std::size_t>(joint.drive.bus)];
    *names += fmt::format("{}{} ({} on {})", names->empty() ? "" : ", ", joint.name,
                          joint.drive.protocol->address(joint.drive), bus.can);
  }

 private:
  std::string commanded_by(int bus, const CanFrame& frame) const {
    std::string names;
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      if (motors_[i].drive.bus != bus || !families_[i].intruders->is_foreign_command(frame))
        continue;
      list(i, &names);
      return names + fmt::format(", frame 0x{:X}", frame.id);
    }
    return names;
  }
  void add(const JointConfig& motor) {
    const bool fd = robot_.buses[static_cast<std::size_t>(motor.drive.bus)].fd;
    families_.push_back(make_drive_family(motor, fd, 1.0 / robot_.rate_hz));
    motors_.push_back(motor);
  }
  /// A slow drive may still be at work on the last request.
  std::int64_t patience_ns(const StartupDialogue& startup) const {
    const double patience_s = startup.patience_cycles() / robot_.rate_hz;
    return std::llround(1e9 * patience_s);
  }
  void mark(int bus, const CanFrame& frame) {
    for (std::size_t i = 0; i < found_.size(); ++i) {
      if (motors_[i].drive.bus != bus) continue;
      if (families_[i].codec->is_mine(frame)) found_[i] = true;
      if (families_[i].startup->has_wrong_reply_id(frame)) wrong_id_[i] = frame.id;
    }
  }

  const Robot& robot_;
  std::span<CanBus* const> buses_;
  bool lockstep_;
  std::vector<JointConfig> motors_;
  std::vector<DriveFamily> families_;
  std::vector<bool> found_;
  std::vector<std::optional<std::uint32_t>> wrong_id_ =
      std::vector<std::optional<std::uint32_t>>(found_.size());
  std::vector<std::int64_t> ask_again_ns_ = std::vector<std::int64_t>(found_.size());
};

}  // namespace

std::string find_foreign_command(const Robot& robot, std::span<CanBus* const> buses) {
  return Discovery(robot, buses, false).foreign_command(monotonic_ns() + kListen_ns);
}

std::string discover_drives(const Robot& robot, std::span<CanBus* const> buses, bool lockstep,
                            double patience_s, const volatile std::sig_atomic_t& stop,
                            const std::function<void(const std::string&)>& tell) {
  Discovery discovery(robot, buses, lockstep);
  const std::int64_t end_ns = monotonic_ns() + static_cast<std::int64_t>(patience_s * 1e9);
  std::int64_t tell_ns = monotonic_ns() + kTell_ns;
  std::string told;
  while (!discovery.complete() && stop == 0 && monotonic_ns() < end_ns) {
    discovery.send_requests();
    discovery.receive_until(monotonic_ns() + kRepeat_ns);
    if (!tell || discovery.complete() || monotonic_ns() < tell_ns) continue;
    const std::string missing = discovery.missing();
    if (missing != told) tell(missing + discovery.disturbed());
    told = missing;
    tell_ns = monotonic_ns() + kTell_ns;
  }
  discovery.drop_stragglers();
  return discovery.missing();
}

std::vector<RoundTrip> measure_round_trips(const Robot& robot, std::span<CanBus* const> buses) {
  Discovery discovery(robot, buses, false);
  std::vector<RoundTrip> all(buses.size());
  for (std::size_t i = 0; i < discovery.size(); ++i) {
    RoundTrip& bus = all[static_cast<std::size_t>(discovery.motor(i).drive.bus)];
    if (bus.asked > 0 || !discovery.prompt(i)) continue;  // one motor a bus
    for (; bus.asked < kRoundTrips; ++bus.asked) {
      std::int64_t took_ns = 0;
      if (discovery.answers(i, 0, &took_ns) == 0) continue;
      bus.least_ns = bus.answered == 0 ? took_ns : std::min(bus.least_ns, took_ns);
      bus.longest_ns = std::max(bus.longest_ns, took_ns);
      ++bus.answered;
    }
  }
  return all;
}

std::string find_twins(const Robot& robot, std::span<CanBus* const> buses) {
  Discovery discovery(robot, buses, false);
  std::string names;
  for (std::size_t i = 0; i < discovery.size(); ++i) {
    std::int64_t ignored_ns = 0;
    int doubled = 0;
    for (int round = 0; round < kTwinRounds; ++round)
      doubled += discovery.answers(i, kTwin_ns, &ignored_ns) > 1 ? 1 : 0;
    if (doubled == kTwinRounds) discovery.list(i, &names);
  }
  return names;
}

}  // namespace limber
