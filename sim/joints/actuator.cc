#include "sim/joints/actuator.h"

#include <algorithm>
#include <cmath>

#include "sim/joints/relax.h"

namespace limber::sim {
namespace {

/// The current of a current loop. Currents that start alike and follow no voltage, the highest and
/// the lowest stay in order, so the voltage's limits bound the end of the step and its mean alike.
Course driven_current(const ActuatorConfig& config, double resistance, double back_emf,
                      double start, double wanted, double h) noexcept {
  const Course course = relax(start, wanted, config.lag_s, h);
  if (!std::isfinite(config.supply_V)) return course;
  const double time_constant = config.inductance_H / resistance;
  const auto at_voltage = [&](double u) {
    return relax(start, (u - back_emf) / resistance, time_constant, h);
  };
  const Course lowest = at_voltage(-config.supply_V);
  const Course highest = at_voltage(config.supply_V);
  return {std::clamp(course.end, lowest.end, highest.end),
          std::clamp(course.mean, lowest.mean, highest.mean)};
}

}  // namespace

Actuator::Actuator(const DriveConfig& real, double believed_torque_constant_Nm_per_A)
    : config_(real.actuator),
      torque_constant_(real.torque_constant_Nm_per_A),
      believed_torque_constant_(believed_torque_constant_Nm_per_A),
      ideal_(config_.kind == ActuatorKind::kIdeal &&
             torque_constant_ == believed_torque_constant_) {}

double Actuator::step(double command_Nm, double theta, double theta_dot, double h) noexcept {
  const double command = std::isfinite(command_Nm) ? command_Nm : 0.0;
  if (config_.kind == ActuatorKind::kHydraulic) {
    const double leakage = config_.leakage_m3_per_s_per_Nm;
    const double rest = command - config_.displacement_m3_per_rad / leakage * theta_dot;
    const Course course =
        relax(pressure_torque_, rest, 1.0 / (config_.fluid_stiffness_Nm_per_m3 * leakage), h);
    pressure_torque_ = course.end;
    torque_ = course.mean;
  } else {
    const double torque = electric(command, theta, theta_dot, h);
    torque_ = ideal_ ? command : torque;
  }
  return torque_;
}

/// A motor of the ideal kind with another torque constant than believed is a current drive without
/// lag.
double Actuator::electric(double command, double theta, double theta_dot, double h) noexcept {
  const double wanted = std::clamp(command / believed_torque_constant_, -config_.current_limit_A,
                                   config_.current_limit_A);
  const double R = resistance();
  const double back_emf = config_.back_emf_Vs_per_rad * theta_dot;
  Course current;
  if (config_.kind == ActuatorKind::kVoltageDrive) {
    const double u =
        std::clamp(config_.resistance_ohm * wanted, -config_.supply_V, config_.supply_V);
    current = relax(current_, (u - back_emf) / R, config_.inductance_H / R, h);
  } else {
    current = driven_current(config_, R, back_emf, current_, wanted, h);
  }
  const double torque = torque_constant_ * (1.0 + config_.magnet_per_K * warmth_) * current.mean +
                        config_.cogging_Nm * std::sin(config_.cogging_periods * theta);
  current_ = current.end;
  if (config_.thermal_resistance_K_per_W > 0.0) {
    const double R_th = config_.thermal_resistance_K_per_W;
    warmth_ = relax(warmth_, R_th * R * current.mean * current.mean,
                    R_th * config_.thermal_capacity_J_per_K, h)
                  .end;
  }
  return torque;
}

double Actuator::resistance() const noexcept {
  return config_.resistance_ohm * (1.0 + config_.copper_per_K * warmth_);
}

void Actuator::reset() noexcept {
  current_ = 0.0;
  pressure_torque_ = 0.0;
  torque_ = 0.0;
  warmth_ = 0.0;
}

}  // namespace limber::sim
