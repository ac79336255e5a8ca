// An arm in the lab, held by its default law, in the cheapest world there is: no friction, one
// Runge-Kutta or ODE step a cycle.
#pragma once

#include <string>

#include "lab/lab.h"
#include "robots/loader/load_robot.h"

namespace limber::bench {

class HeldArm {
 public:
  /// Active after this. Throws ConfigError.
  HeldArm(const std::string& robot, Integrator integrator);

  void run(std::int64_t cycles) noexcept {
    for (std::int64_t i = 0; i < cycles; ++i) lab_.step();
  }
  /// Throws std::runtime_error if the controller is not ACTIVE.
  void require_held() const;

 private:
  LoadedRobot robot_;
  Scenario scenario_;
  Lab lab_;
};

}  // namespace limber::bench
