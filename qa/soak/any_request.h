// Requests at random from all that the message can hold: any law, choice, goal and wrench.
#pragma once

#include <cmath>
#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <random>
#include <string>
#include <vector>

#include "robots/loader/load_robot.h"

namespace limber::soak {

/// What the controller must be able to bear, whatever it accepts: it may refuse any of these.
class AnyRequest {
 public:
  /// The robot outlives this. Set-up only.
  AnyRequest(const LoadedRobot& robot, std::mt19937_64* random) : robot_(robot), random_(*random) {}

  /// Of all laws but the demonstrations, with each choice of the gain table, 0.02 to 3 times the
  /// robot's own stiffness (each direction apart, some without any), ramps of 0 to 1 s.
  compliance_gains_t gains();
  /// At the joints up to their very ends, at the tip, circles and feed-forward wrenches; half of
  /// them as fast as may be, some with an end of validity.
  compliance_goal_t goal();

 private:
  double uniform(double low, double high);
  double scale() { return std::exp(uniform(std::log(0.02), std::log(3.0))); }
  bool one_in(std::size_t n) { return random_() % n == 0; }
  void choose(compliance_gains_t* gains);
  void aim(compliance_goal_t* goal);

  const LoadedRobot& robot_;
  std::mt19937_64& random_;
};

}  // namespace limber::soak
