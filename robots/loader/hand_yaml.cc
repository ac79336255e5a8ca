#include "robots/loader/hand_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/complaints.h"
#include "robots/loader/joint_yaml.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

constexpr const char* kName = "hand";
constexpr double kMostWidth_m = 1.0;
constexpr double kYields = 0.1;  // of the travel, each way

HandTravel read_travel(const YamlMap& yaml) {
  const auto widths = yaml.numbers("width_m", -1, {0.0, kMostWidth_m});
  const auto angles = yaml.numbers("angle_rad", -1, {-1e3, 1e3});
  yaml.finish();
  const std::size_t n = widths.size();
  if (n < 2 || n > HandTravel::kMostPoints)
    yaml.refuse("width_m",
                fmt::format("found {} points; expected 2 to {}", n, HandTravel::kMostPoints));
  if (angles.size() != n)
    yaml.refuse("angle_rad", fmt::format("found {} angles for {} widths", angles.size(), n));
  HandTravel travel;
  travel.count = n;
  for (std::size_t i = 0; i < n; ++i) {
    travel.points[i] = {widths[i], angles[i]};
    if (i == 0) continue;
    if (!(widths[i] - widths[i - 1] >= 1e-4))
      yaml.refuse("width_m", fmt::format("{} follows {}; expected widths that rise by 0.1 mm or "
                                         "more, from closed to open",
                                         widths[i], widths[i - 1]));
    const double step = angles[i] - angles[i - 1];
    if (!(std::abs(step) >= 1e-4 && (step > 0.0) == travel.rises()))
      yaml.refuse("angle_rad", fmt::format("{} follows {}; expected angles that all rise, or all "
                                           "fall, by 1e-4 or more",
                                           angles[i], angles[i - 1]));
  }
  return travel;
}

/// The motor's torque bounds the force by the table's steepest piece, its speed that of the width
/// by the flattest.
void read_limits(const YamlMap& yaml, HandConfig* hand) {
  JointConfig& drive = hand->drive;
  const double torque_Nm = std::min(drive.drive.peak_torque_Nm, drive.drive.range.torque_Nm);
  const double most_N = torque_Nm / hand->travel.steepest();
  hand->force_limit_N = yaml.number("force_limit_N", {0.1, 1e5});
  if (!(hand->force_limit_N <= most_N))
    yaml.refuse("force_limit_N",
                fmt::format("{} N needs {:.4g} N m where the travel table is steepest; the motor's "
                            "{:g} allow {:.4g} N",
                            hand->force_limit_N, hand->force_limit_N * hand->travel.steepest(),
                            torque_Nm, most_N));
  drive.torque_limit_Nm = hand->force_limit_N * hand->travel.steepest();
  drive.torque_rate_limit_Nm_per_s = yaml.number_or("torque_rate_limit_Nm_per_s", {1e-3, 1e6},
                                                    std::min(drive.torque_limit_Nm / 0.02, 1000.0));
  drive.velocity_limit = yaml.number("velocity_limit_rad_per_s", {1e-3, 1e3});
  if (!(drive.velocity_limit <= drive.drive.range.velocity_rad_per_s))
    yaml.refuse("velocity_limit_rad_per_s",
                fmt::format("{} is more than the {} that the drive reports", drive.velocity_limit,
                            drive.drive.range.velocity_rad_per_s));
  const double fastest = drive.velocity_limit * hand->travel.flattest();
  hand->speed_limit_m_per_s = yaml.number("speed_limit_m_per_s", {1e-3, 10.0});
  if (!(hand->speed_limit_m_per_s <= fastest))
    yaml.refuse("speed_limit_m_per_s",
                fmt::format("{} is more than the {:.4g} of velocity_limit_rad_per_s where the "
                            "travel table is flattest",
                            hand->speed_limit_m_per_s, fastest));
  hand->rated_torque_Nm = yaml.number("continuous_torque_Nm", {1e-3, 5e4});
  if (!(hand->rated_torque_Nm <= drive.drive.peak_torque_Nm))
    yaml.refuse("continuous_torque_Nm",
                fmt::format("{} is more than the motor's peak, {}", hand->rated_torque_Nm,
                            drive.drive.peak_torque_Nm));
  const double rated_N = hand->rated_torque_Nm / hand->travel.steepest();
  hand->hold_force_N = yaml.number_or("hold_force_N", {0.1, hand->force_limit_N},
                                      std::min(rated_N, hand->force_limit_N));
  if (!(hand->hold_force_N <= rated_N * (1.0 + 1e-9)))
    yaml.refuse("hold_force_N",
                fmt::format("{} is more than the {:.4g} N that continuous_torque_Nm "
                            "holds for ever",
                            hand->hold_force_N, rated_N));
  hand->heat_time_constant_s = yaml.number("heat_time_constant_s", {0.1, 1e4});
}

/// As a joint of the driver: its way, its drive and how that holds.
void read_drive(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors, Robot* robot,
                HandConfig* hand) {
  JointConfig& drive = hand->drive;
  const auto [low, high] = std::minmax(hand->travel.points[0].angle_rad,
                                       hand->travel.points[hand->travel.count - 1].angle_rad);
  drive.name = kName;
  // Fingers and linkage yield at their ends; further away the reading is wrong.
  const double margin = kYields * (high - low);
  drive.position_min = low - margin;
  drive.position_max = high + margin;
  read_hand_drive(yaml, motors, robot, &drive);
}

}  // namespace

void read_hand(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors,
               Robot* robot) {
  HandConfig hand;
  Complaints complaints(yaml.file());
  const bool known = complaints.collect([&] { hand.travel = read_travel(yaml.map("travel")); });
  const bool driven = known && complaints.collect([&] { read_drive(yaml, motors, robot, &hand); });
  if (driven) complaints.collect([&] { read_limits(yaml, &hand); });
  complaints.collect([&] {
    hand.stiffness_N_per_m = yaml.number("stiffness_N_per_m", {1.0, 1e6});
    hand.damping_Ns_per_m = yaml.number("damping_Ns_per_m", {0.0, 1e5});
    if (yaml.has("grasp_point_m")) {
      const auto p = yaml.numbers("grasp_point_m", 3, {-1.0, 1.0});
      std::copy(p.begin(), p.end(), hand.p_TG);
    }
    hand.finger_mass_kg = yaml.number_or("finger_mass_kg", {0.0, 10.0}, 0.0);
  });
  complaints.throw_if_any();
  const double inertia_kg = hand.mass_kg(hand.travel.steepest());
  const double period_s = 1.0 / robot->rate_hz;
  // A sampled damper is stable below 2 m / T, a sampled spring below about D / T; half of both.
  if (!(hand.damping_Ns_per_m * period_s <= inertia_kg))
    yaml.refuse(
        "damping_Ns_per_m",
        fmt::format("{} with {:.3g} kg of motor and fingers is unstable at {:g} Hz; at most "
                    "{:.4g}",
                    hand.damping_Ns_per_m, inertia_kg, robot->rate_hz, inertia_kg / period_s));
  if (!(hand.stiffness_N_per_m * period_s <= 0.5 * hand.damping_Ns_per_m))
    yaml.refuse("stiffness_N_per_m",
                fmt::format("{} with a damping of {} is unstable at {:g} Hz; at most {:.4g}",
                            hand.stiffness_N_per_m, hand.damping_Ns_per_m, robot->rate_hz,
                            0.5 * hand.damping_Ns_per_m / period_s));
  yaml.finish();
  const double start_m = hand.travel.open_m();
  hand.drive.home = hand.travel.angle(start_m);
  robot->hand = hand;
}

}  // namespace limber
