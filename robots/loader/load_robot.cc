#include "robots/loader/load_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "common/config_error.h"
#include "common/shared_folder.h"
#include "common/suggest.h"
#include "robots/loader/doubtful_figures.h"
#include "robots/loader/mass_check.h"
#include "robots/loader/required_keys.h"
#include "robots/loader/robot_yaml.h"
#include "robots/loader/urdf_chain.h"

namespace limber {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> shipped_robots() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(robots_root(), error)) {
    if (is_robot_folder(entry.path())) names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path find_robot(const std::string& name_or_path) {
  const bool is_name =
      name_or_path.find('/') == std::string::npos && !name_or_path.starts_with('.');
  if (is_name && is_robot_folder(fs::path(robots_root()) / name_or_path))
    return fs::path(robots_root()) / name_or_path;
  if (!name_or_path.empty() && is_robot_folder(name_or_path)) return name_or_path;
  throw ConfigError(no_robot_text(name_or_path));
}

LoadedRobot from_chain(UrdfChain parts, const std::string& path, const std::string& base,
                       const std::string& tip, const double gravity_R[3]) {
  LoadedRobot loaded;
  loaded.robot.urdf_path = path;
  loaded.robot.base = base;
  loaded.robot.tip = tip;
  const KDL::Vector gravity_B =
      parts.R_RB.Inverse(KDL::Vector(gravity_R[0], gravity_R[1], gravity_R[2]));
  for (int i = 0; i < 3; ++i) loaded.robot.gravity[i] = gravity_B(i);
  loaded.robot.joints = std::move(parts.joints);
  loaded.model = std::move(parts.model);
  loaded.chain = parts.chain;
  loaded.segment_links = std::move(parts.segment_links);
  loaded.notes = std::move(parts.notes);
  return loaded;
}

/// A robot that moves needs limits.
void refuse_placeholders(const std::vector<std::string>& placeholders) {
  std::string text;
  for (const std::string& line : placeholders) {
    text += (text.empty() ? "" : "\n") + line +
            ": no limit; correct it, or give the limits in robot.yaml and let this joint have "
            "urdf_limits: ignore there";
  }
  if (!text.empty()) throw ConfigError(text);
}

/// The tool is part of what the last joint carries.
void check_tool_mass(const YamlMap& yaml, const LoadedRobot& loaded) {
  if (!loaded.robot.has_tip_sensor) return;
  double carried_kg = 0.0;
  for (const KDL::Segment& segment : loaded.chain.segments) {
    if (segment.getJoint().getType() != KDL::Joint::Fixed) carried_kg = 0.0;
    carried_kg += segment.getInertia().getMass();
  }
  if (loaded.robot.tip_sensor.tool_mass_kg <= carried_kg) return;
  yaml.map("tip_sensor")
      .map("tool")
      .refuse("mass_kg",
              fmt::format("{} is more than the {:.4g} kg that the last joint carries; the "
                          "tool must be part of the URDF",
                          loaded.robot.tip_sensor.tool_mass_kg, carried_kg));
}

/// Gains that are soft on any arm, for one that nobody has tuned.
void fill_default_gains(Robot* robot) {
  const auto n = static_cast<std::size_t>(robot->size());
  robot->gains.K_q.assign(n, 20.0);
  robot->gains.K_null.assign(n, 0.0);
  robot->gains.D_null.assign(n, 0.5);
}

LoadedRobot load_from(const YamlMap& yaml, const fs::path& folder) {
  check_required_keys(yaml);
  const RobotHeader header = read_robot_header(yaml);
  std::error_code error;
  if (!fs::is_regular_file(folder / header.urdf, error))
    yaml.refuse("urdf", fmt::format("no file '{}' in {}", header.urdf, folder.string()));
  const std::string path = folder / header.urdf;
  const UrdfChain parts =
      build_urdf_chain(path, header.base, header.tip, header.ignored_urdf_limits);
  refuse_placeholders(parts.placeholders);
  LoadedRobot loaded = from_chain(parts, path, header.base, header.tip, header.gravity_R);
  loaded.robot.name = header.name;
  loaded.robot.folder = folder;
  read_robot_yaml(yaml, &loaded.robot);
  check_tool_mass(yaml, loaded);
  check_mass_matrix(loaded, parts.unphysical);
  for (std::string& note : doubtful_figures(yaml, loaded.robot))
    loaded.notes.push_back(std::move(note));
  return loaded;
}

}  // namespace

std::string no_robot_text(const std::string& name) {
  const auto names = shipped_robots();
  const std::string near = nearest_word(name, names);
  return fmt::format("no robot '{}'{}; expected a folder with robot.yaml, or one of: {}", name,
                     near.empty() ? "" : "; did you mean '" + near + "'?", joined(names));
}

LoadedRobot load_robot(const std::string& name_or_path) {
  const fs::path folder = find_robot(name_or_path);
  return load_from(YamlMap::from_file(folder / "robot.yaml"), folder);
}

LoadedRobot load_plant(const std::string& name_or_path, const YamlMap& plant) {
  const fs::path folder = find_robot(name_or_path);
  return load_from(YamlMap::from_file(folder / "robot.yaml").merged_with(plant), folder);
}

LoadedRobot load_urdf(const std::string& urdf_path, const std::string& base, const std::string& tip,
                      const double gravity[3]) {
  for (int i = 0; i < 3; ++i) {
    if (!(std::abs(gravity[i]) <= 30.0)) {
      throw ConfigError(
          fmt::format("gravity: {} m/s^2 is out of range; expected three numbers "
                      "from -30 to 30",
                      gravity[i]));
    }
  }
  const UrdfChain parts = build_urdf_chain(urdf_path, base, tip, {});
  LoadedRobot loaded = from_chain(parts, urdf_path, base, tip, gravity);
  loaded.robot.name = fs::path(urdf_path).stem();
  for (const std::string& line : parts.placeholders)
    loaded.notes.push_back(line + ": no limit; robot.yaml needs urdf_limits: ignore for it");
  for (JointConfig& joint : loaded.robot.joints) {
    const bool zero_inside = joint.position_min <= 0.0 && joint.position_max >= 0.0;
    joint.home = zero_inside ? 0.0 : 0.5 * (joint.position_min + joint.position_max);
    joint.torque_rate_limit_Nm_per_s = std::min(joint.torque_limit_Nm / 0.02, 1000.0);
  }
  fill_default_gains(&loaded.robot);
  check_mass_matrix(loaded, parts.unphysical);
  return loaded;
}

bool is_robot_folder(const std::string& folder) {
  std::error_code error;
  return fs::is_regular_file(fs::path(folder) / "robot.yaml", error);
}

std::string robots_root() {
  const char* folder = std::getenv("LIMBER_ROBOTS");
  return folder != nullptr && *folder != '\0' ? folder : shared_folder() + "/robots";
}

}  // namespace limber
