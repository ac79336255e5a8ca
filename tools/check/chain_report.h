// What limber-check says of joints that are not rigid: springs, sensors, torque loops.
#pragma once

#include <string>
#include <vector>

#include "robots/loader/robot.h"
#include "tools/check/json.h"

namespace limber {

/// Largest inertia ratio rho = B / B_theta of a joint's torque loop that the rule of sampled torque
/// feedback allows, infinite without a bound. The feedback comes T/2 + t_d late, which takes
/// (rho - 1) K_J (T/2 + t_d) of damping and, as it feeds the joint damper back too, gives
/// (rho - 1) D_J; the motor's friction d and the damper D_J have to pay:
///   (rho - 1) (K_J (T/2 + t_d) - D_J) < d + D_J
/// (Albu-Schaeffer, Ott, Hirzinger 2007 for the loop; first order in the delay).
double largest_inertia_ratio(const JointConfig& joint);

/// A table of springs, sensors and loops; empty if all joints are rigid.
std::string chain_table(const Robot& robot);
/// Members of a joint's JSON object: transmission, stiffness, friction, sensors, torque loop.
json::Members chain_members(const JointConfig& joint);
/// What to think about: loops faster than their rule allows.
std::vector<std::string> chain_warnings(const Robot& robot);

}  // namespace limber
