// A user who never stops: goals, gains, laws, pushes, stops, and now and then a fault of a drive.
// None but the faults is a reason to trip.
#pragma once

#include <array>
#include <cstdint>
#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/push_t.hpp>
#include <limber/scenario_event_t.hpp>
#include <random>
#include <string>
#include <vector>

#include "qa/soak/any_request.h"
#include "robots/loader/load_robot.h"

namespace limber::soak {

enum class Action : std::uint8_t { kGoal, kGains, kPush, kStop, kFault };
inline constexpr std::array kActionNames = {"goals", "gains", "pushes", "stops", "faults"};

enum class Habit : std::uint8_t {
  kCareful,  ///< what the arm can do well; pushes, stops and faults besides
  kAnything  ///< AnyRequest and stops, up to fifty requests a second
};

class RandomUser {
 public:
  /// The robot outlives the user. Set-up only.
  RandomUser(const LoadedRobot& robot, std::uint64_t seed, Habit habit = Habit::kCareful);

  /// The next thing to do, and how long to wait before it, s.
  Action next_action();
  double next_pause_s();

  compliance_goal_t goal();
  /// A law the arm can run, with 0.3 to 1.5 times the robot's own stiffness.
  compliance_gains_t gains();
  push_t push();
  /// 2 ms to 0.4 s of one of the four kinds, in one drive.
  scenario_event_t fault();

  const std::vector<std::string>& laws() const { return laws_; }

 private:
  double uniform(double low, double high);
  std::size_t below(std::size_t end) { return static_cast<std::size_t>(random_() % end); }

  const LoadedRobot& robot_;
  Habit habit_;
  std::mt19937_64 random_;
  AnyRequest any_;
  std::vector<std::string> laws_;
};

}  // namespace limber::soak
