// Hours of arm time in lock step. Every cycle is judged: numbers are finite, torques within their
// limits, and the drives leave ON only for a fault that was injected.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lab/lab.h"
#include "qa/soak/process_size.h"
#include "qa/soak/random_user.h"

namespace limber::soak {

struct SoakResult {
  std::int64_t cycles = 0;
  std::array<std::int64_t, kActionNames.size()> actions{};
  std::map<std::string, std::int64_t> refused;  ///< reason the controller gave -> requests
  /// How often an injected kind of fault (FAULT_* of scenario_event_t) led to a cause (FAULT_* of
  /// joint_state_t; 0: bridged, or not noticed).
  std::map<std::pair<int, int>, std::int64_t> trips;
  std::int64_t recoveries = 0;
  double longest_recovery_s = 0.0;  ///< of those that were not put back
  std::int64_t put_back = 0;        ///< fell out of its range, and was moved home by hand
  /// Of Habit::kAnything: causes (FAULT_* of joint_state_t) that are not a joint beyond its limits.
  std::map<int, std::int64_t> other_trips;
  std::vector<std::string> violations;  ///< what must not be: empty if all is well
  ProcessSize size_begin;               ///< after the first minute of arm time
  ProcessSize size_end;
  ProcessSize size_most;
};

class Soak {
 public:
  /// Throws ConfigError. The robot outlives the soak.
  Soak(const LoadedRobot& robot, std::uint64_t seed, Habit habit = Habit::kCareful);

  /// Runs until `arm_time_s`, until the first violation, or until `go_on()` says no, which is asked
  /// every second of arm time.
  const SoakResult& run(double arm_time_s, const std::function<bool()>& go_on);

  const SoakResult& result() const { return result_; }
  double time_s() const;

 private:
  enum class Phase : std::uint8_t { kStarting, kWorking, kFaulty };

  void cycle();
  void judge();
  void judge_numbers();
  void judge_trip();
  /// State of the drives and faults, of driver and controller.
  std::string trip_text();
  void act();
  void inject();
  void recover();
  bool must_restart_drives() const;
  bool at_rest() const;
  bool out_of_range() const;
  void put_back();
  void end_fault();
  void request(std::int8_t what);
  void violated(const std::string& what);
  void measure_process();

  const LoadedRobot& robot_;
  Scenario scenario_;
  std::optional<Lab> lab_;
  Habit habit_;
  RandomUser user_;
  SoakResult result_;
  Phase phase_ = Phase::kStarting;
  double phase_since_s_ = 0.0;
  double next_action_s_ = 0.0;
  double fault_end_s_ = 0.0;
  int injected_ = -1;
  int cause_ = 0;
  std::int64_t requests_ = 0;
};

}  // namespace limber::soak
