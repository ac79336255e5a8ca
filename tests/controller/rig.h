// A controller at an arm whose driver is perfect: the loop without bus, drives and clock.
#pragma once

#include <optional>

#include "controller/arm_controller.h"
#include "tests/controller/arms.h"
#include "tests/controller/elastic_plant.h"

namespace limber::testing {

inline constexpr std::int64_t kClient = 7;

/// Each step() is one millisecond: JOINT_STATE from the exact plant, the controller's answer, and
/// the plant moved on by the torque of the answer before, as over a real bus. The drive states
/// follow the controller's requests after one cycle. Drives that are not on leave the arm braked.
class Rig {
 public:
  explicit Rig(const LoadedRobot& robot, const std::string& law = "cartesian_impedance",
               int bridged_cycles = 2);

  /// One cycle; returns the answer.
  const joint_command_t& step();
  void run(double seconds);
  /// From the start to HOLD, or ACTIVE, with the drives on and the torque settled.
  void to_hold();
  void to_active();

  const char* request(std::int8_t request, std::int64_t client = kClient);
  compliance_gains_t gains() const;  ///< the robot's default gains as a message
  compliance_goal_t goal() const;    ///< GOAL_OFFSET of zero
  std::int8_t mode() const { return controller.status().mode; }
  VectorJ tau() const;
  /// Greatest change of a joint's torque between answers since the last call of clear_jumps().
  double jump() const { return jump_; }
  /// LIMIT_* bits seen since then.
  int limits() const { return limits_; }
  void clear_jumps();

  LoadedRobot robot;
  ArmController controller;
  Plant plant;
  std::optional<ElasticPlant> elastic;  ///< of an arm with springs; q, v and F_ext are plant's
  VectorJ viscous;  ///< friction of the plant's joints, N m s/rad; none unless set
  joint_state_t state{};
  joint_command_t answer{};

 private:
  void follow_request();
  void move(const VectorJ& sent);
  void read_sensors(const VectorJ& sent);

  double jump_ = 0.0;
  int limits_ = 0;
};

}  // namespace limber::testing
