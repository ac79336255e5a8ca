// An arm that nobody has built, with everything a law may receive at it. Seeded.
#pragma once

#include <random>

#include "controller/kinds/estimates.h"
#include "controller/kinds/gains.h"
#include "controller/kinds/goal.h"
#include "robots/loader/load_robot.h"

namespace limber {

class RandomArm {
 public:
  explicit RandomArm(int seed) : generator_(static_cast<unsigned>(seed)) {}

  /// Revolute and prismatic joints about random axes; with the springs and motors that a law needs
  /// (controller/kinds/sensors.h).
  LoadedRobot arm(int joints, unsigned needs);
  /// n entries from -size to size.
  VectorJ joints(int n, double size);
  /// Stiffness, damping, settings, and every number that some law declares, within its range.
  void choose(controller::Gains* gains);
  /// A goal that moves, and a world that pushes.
  void move(int n, controller::Goal* goal, controller::Estimates* estimates);

 private:
  double uniform(double low, double high);
  int below(int count);
  Vector6 six(double size);
  Matrix6 stiffness(double linear, double angular);

  std::mt19937 generator_;
};

}  // namespace limber
