#include "robots/loader/doubtful_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "robots/loader/joint_chain_yaml.h"

namespace limber {
namespace {

constexpr double kFastest_rad_per_s = 60.0;  // ten turns a second, behind the gear
constexpr double kFastest_m_per_s = 10.0;
constexpr double kLongest_m = 10.0;
constexpr double kMostFriction = 0.5;       // of the joint's torque limit
constexpr double kMostViscous = 10.0;       // of the same, at the velocity limit
constexpr double kMostCurrent_A = 1000.0;   // at the peak torque
constexpr double kLeastAcceleration = 5.0;  // rad/s^2 or m/s^2, of the motor alone at its peak
constexpr double kDegree = std::numbers::pi / 180.0;

/// VMAX in rad/s and TMAX in N m of the makers' tables: the pairs that Damiao motors are sold with.
struct MitPair {
  double velocity;
  double torque;
};
constexpr std::array<MitPair, 11> kDamiaoPairs = {{{30, 10},
                                                   {50, 10},
                                                   {8, 28},
                                                   {10, 28},
                                                   {45, 20},
                                                   {45, 40},
                                                   {45, 54},
                                                   {25, 200},
                                                   {20, 200},
                                                   {280, 1},
                                                   {45, 10}}};

bool is_sold(double velocity, double torque) {
  return std::ranges::any_of(kDamiaoPairs, [&](const MitPair& pair) {
    return pair.velocity == velocity && pair.torque == torque;
  });
}

/// "0.218 N m if these are mN m": what the figure would be in other units, if it then is sensible.
std::string other_torque(double value, const JointConfig& joint) {
  const double most = kMostFriction * joint.torque_limit_Nm;
  const char* unit = units_of(joint).force == "_N" ? "N" : "N m";
  std::string text;
  const auto offer = [&](double scaled, const std::string& name) {
    if (scaled < most)
      text += fmt::format("{}{:.3g} {} {}", text.empty() ? "" : ", ", scaled, unit, name);
  };
  offer(1e-3 * value * joint.drive.peak_torque_Nm, "if it is in thousandths of the motor's torque");
  offer(1e-3 * value, fmt::format("if it is in m{}", unit));
  return text.empty() ? "" : "; it would be " + text;
}

void check_friction(const YamlMap& yaml, const std::string& section, const FrictionConfig& friction,
                    const JointConfig& joint, std::vector<std::string>* notes) {
  if (!yaml.is_map(section)) return;
  const YamlMap part = yaml.map(section);
  const JointUnits& units = units_of(joint);
  const double limit = joint.torque_limit_Nm;
  for (const auto& [name, value] :
       {std::pair{"coulomb", friction.coulomb_Nm}, std::pair{"static", friction.static_Nm}}) {
    const std::string key = name + units.force;
    if (!part.has(key) || !(value > kMostFriction * limit)) continue;
    notes->push_back(part.note(
        key, fmt::format("{:.4g} is {:.3g} times the torque of the joint, {:.4g}: {}{}", value,
                         value / limit, limit,
                         value >= limit ? "its motor could not move it" : "most of it is lost",
                         other_torque(value, joint))));
  }
  const std::string viscous = "viscous" + units.damping;
  const double most = friction.viscous_Nms_per_rad * joint.velocity_limit;
  if (part.has(viscous) && std::isfinite(most) && most > kMostViscous * limit) {
    notes->push_back(part.note(
        viscous, fmt::format("at the velocity limit, {:.4g}, it takes {:.4g}; the torque of the "
                             "joint is {:.4g}{}",
                             joint.velocity_limit, most, limit,
                             most * kDegree < kMostFriction * limit
                                 ? fmt::format("; per degree? {:.3g} would be per radian",
                                               friction.viscous_Nms_per_rad * kDegree)
                                 : "")));
  }
}

void check_joint(const YamlMap& yaml, const JointConfig& joint, std::vector<std::string>* notes) {
  const bool slides = joint.type == JointType::kPrismatic;
  const std::string velocity = "velocity_limit" + units_of(joint).velocity;
  const std::string doubt = doubtful_speed(joint.velocity_limit, slides);
  if (yaml.has(velocity) && !doubt.empty())
    notes->push_back(yaml.note(velocity, fmt::format("{:.4g}{}", joint.velocity_limit, doubt)));
  for (const char* end : {"position_min", "position_max"}) {
    const std::string key = end + units_of(joint).position;
    const double value = key.starts_with("position_min") ? joint.position_min : joint.position_max;
    if (slides && yaml.has(key) && !doubtful_length(value).empty())
      notes->push_back(yaml.note(key, fmt::format("{:.4g} m{}", value, doubtful_length(value))));
  }
  check_friction(yaml, "friction", joint.friction, joint, notes);
  check_friction(yaml, "link_friction", joint.link_friction, joint, notes);
}

void check_mit_range(const YamlMap& motor, const DriveConfig& drive,
                     std::vector<std::string>* notes) {
  if (!motor.is_map("mit_range")) return;
  const CommandRange& range = drive.range;
  const double velocity = range.velocity_rad_per_s;
  const double torque = range.torque_Nm;
  const bool sold = is_sold(torque, velocity) && !is_sold(velocity, torque);
  // The field is far too wide for the motor, and the other figure would be right.
  const bool fits = torque > 2.5 * drive.peak_torque_Nm && velocity >= drive.peak_torque_Nm &&
                    velocity <= 2.5 * drive.peak_torque_Nm;
  if (!sold && !fits) return;
  notes->push_back(
      motor.map("mit_range")
          .note("torque_Nm",
                fmt::format(
                    "VMAX {:g} and TMAX {:g} with a peak torque of {:g} N m: are they exchanged? "
                    "velocity_rad_per_s: {:g}, torque_Nm: {:g} would be {}; the drive shows both",
                    velocity, torque, drive.peak_torque_Nm, torque, velocity,
                    sold ? "those of a motor that is sold" : "near the peak torque")));
}

void check_motor(const YamlMap& motor, const DriveConfig& drive, std::vector<std::string>* notes) {
  check_mit_range(motor, drive, notes);
  const double current_A = drive.peak_torque_Nm / drive.torque_constant_Nm_per_A;
  if (current_A > kMostCurrent_A) {
    notes->push_back(motor.note(
        "rotor_torque_constant_Nm_per_A",
        fmt::format("the peak torque, {:g}, would take {:.3g} A; is the peak torque in mN m, or "
                    "the gear ratio missing?",
                    drive.peak_torque_Nm, current_A)));
  }
  const double acceleration = drive.peak_torque_Nm / drive.rotor_inertia_kgm2;
  if (acceleration < kLeastAcceleration) {
    notes->push_back(motor.note(
        "rotor_inertia_kgm2",
        fmt::format("behind the gear it is {:.3g} kg m^2, so that the peak torque moves the bare "
                    "rotor by {:.2g} rad/s^2 only; g cm^2 are 1e-7 kg m^2, and it is before the "
                    "gear",
                    drive.rotor_inertia_kgm2, acceleration)));
  }
}

}  // namespace

std::string doubtful_speed(double speed, bool slides) {
  if (!std::isfinite(speed)) return "";
  if (slides) {
    return speed > kFastest_m_per_s
               ? fmt::format(" m/s is no speed of a joint; are these mm/s? {:.4g} m/s",
                             1e-3 * speed)
               : "";
  }
  return speed > kFastest_rad_per_s
             ? fmt::format(
                   " rad/s is {:.3g} turns a second; are these degrees per second? {:.4g} "
                   "rad/s",
                   speed / (2.0 * std::numbers::pi), kDegree * speed)
             : "";
}

std::string doubtful_length(double length_m) {
  if (!std::isfinite(length_m) || std::abs(length_m) <= kLongest_m) return "";
  return fmt::format("; are these millimetres? {:.4g} m", 1e-3 * length_m);
}

std::vector<std::string> doubtful_figures(const YamlMap& yaml, const Robot& robot) {
  std::vector<std::string> notes;
  const YamlMap motors = yaml.map("motors");
  const YamlMap joints = yaml.map("joints");
  std::set<std::string> told;
  for (const JointConfig& joint : robot.joints) {
    if (told.insert(joint.drive.motor).second)
      check_motor(motors.map(joint.drive.motor), joint.drive, &notes);
    check_joint(joints.map(joint.name), joint, &notes);
  }
  return notes;
}

}  // namespace limber
