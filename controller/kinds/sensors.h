// What an arm has to be measured with, and what its joints are made of.
#pragma once

#include "robots/loader/robot.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// What a law may need of an arm, to be combined with |.
namespace sensors {
inline constexpr unsigned kLinkEncoder = 1;   ///< q, v: on a rigid joint the motor's encoder does
inline constexpr unsigned kMotorEncoder = 2;  ///< theta, theta_dot
inline constexpr unsigned kTorqueSensor = 4;  ///< tau_measured from a sensor, not from the current
inline constexpr unsigned kTipForceSensor = 8;
inline constexpr unsigned kElasticJoints = 16;  ///< a spring between motor and link everywhere
inline constexpr unsigned kTwoMotors = 32;      ///< that pull against each other, everywhere
inline constexpr unsigned kDeflection = 64;  ///< of the springs, by link encoder or torque sensor
inline constexpr unsigned kSprings = 128;    ///< some joint is not rigid
}  // namespace sensors

/// What this arm has, sensors::*. A rigidly geared joint's encoder serves both sides. Set-up only.
unsigned sensors_of(const Robot& robot) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
