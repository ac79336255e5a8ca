#include "robots/loader/actuator_yaml.h"

namespace limber {
namespace {

void read_electric(const YamlMap& yaml, ActuatorConfig* actuator) {
  if (actuator->kind == ActuatorKind::kCurrentDrive)
    actuator->lag_s = yaml.number_or("lag_s", {0.0, 1.0}, 0.0);
  actuator->inductance_H = yaml.number_or("inductance_H", {0.0, 1.0}, 0.0);
  actuator->back_emf_Vs_per_rad = yaml.number_or("back_emf_Vs_per_rad", {0.0, 1e3}, 0.0);
  actuator->supply_V = yaml.number_or("supply_V", {0.1, 1e3}, actuator->supply_V);
  actuator->current_limit_A =
      yaml.number_or("current_limit_A", {1e-3, 1e4}, actuator->current_limit_A);
  actuator->magnet_per_K = yaml.number_or("magnet_per_K", {-0.01, 0.0}, 0.0);
  actuator->copper_per_K = yaml.number_or("copper_per_K", {0.0, 0.01}, 0.0);
  actuator->thermal_resistance_K_per_W =
      yaml.number_or("thermal_resistance_K_per_W", {0.0, 1e3}, 0.0);
  actuator->thermal_capacity_J_per_K =
      yaml.number_or("thermal_capacity_J_per_K", {1e-3, 1e6}, actuator->thermal_capacity_J_per_K);
  actuator->cogging_Nm = yaml.number_or("cogging_Nm", {0.0, 100.0}, 0.0);
  actuator->cogging_periods = static_cast<int>(yaml.integer_or("cogging_periods", 0, 1'000'000, 0));
}

void read_hydraulic(const YamlMap& yaml, ActuatorConfig* actuator) {
  actuator->fluid_stiffness_Nm_per_m3 = yaml.number("fluid_stiffness_Nm_per_m3", {1e-3, 1e15});
  actuator->leakage_m3_per_s_per_Nm = yaml.number("leakage_m3_per_s_per_Nm", {1e-15, 1e3});
  actuator->displacement_m3_per_rad = yaml.number("displacement_m3_per_rad", {0.0, 1e3});
}

}  // namespace

namespace {

/// Keys of the other kinds.
void refuse_other_kinds(const YamlMap& yaml, ActuatorKind kind) {
  const bool electric = kind == ActuatorKind::kCurrentDrive || kind == ActuatorKind::kVoltageDrive;
  if (kind != ActuatorKind::kCurrentDrive) yaml.leave_to("kind: current_drive", {"lag_s"});
  if (!electric) {
    yaml.leave_to("kind: current_drive or voltage_drive",
                  {"inductance_H", "back_emf_Vs_per_rad", "supply_V", "current_limit_A",
                   "magnet_per_K", "copper_per_K", "thermal_resistance_K_per_W",
                   "thermal_capacity_J_per_K", "cogging_Nm", "cogging_periods"});
  }
  if (kind != ActuatorKind::kHydraulic) {
    yaml.leave_to("kind: hydraulic", {"fluid_stiffness_Nm_per_m3", "leakage_m3_per_s_per_Nm",
                                      "displacement_m3_per_rad"});
  }
}

}  // namespace

ActuatorConfig read_actuator(const YamlMap& yaml) {
  ActuatorConfig actuator;
  const std::string kind =
      yaml.word("kind", {"ideal", "current_drive", "voltage_drive", "hydraulic"});
  if (kind == "current_drive") actuator.kind = ActuatorKind::kCurrentDrive;
  if (kind == "voltage_drive") actuator.kind = ActuatorKind::kVoltageDrive;
  if (kind == "hydraulic") {
    actuator.kind = ActuatorKind::kHydraulic;
    read_hydraulic(yaml, &actuator);
  } else if (kind != "ideal") {
    read_electric(yaml, &actuator);
  }
  refuse_other_kinds(yaml, actuator.kind);
  yaml.finish();
  return actuator;
}

}  // namespace limber
