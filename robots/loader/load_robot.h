// Reads a robot folder (robot.urdf + robot.yaml) or a bare URDF, checks all of it, builds the
// kinematic chain.
#pragma once

#include <urdf_world/types.h>

#include <kdl/chain.hpp>
#include <string>
#include <vector>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// A checked arm: plain data and the KDL chain from base to tip.
/// The chain's inertias carry every side branch and everything behind the tip as load (branch
/// joints frozen at zero); fixed and massless links stay as segments. KDL joint inertia is left
/// zero: rotors are in DriveConfig.
struct LoadedRobot {
  Robot robot;
  std::shared_ptr<const urdf::ModelInterface> model;  ///< all of the URDF's tree, see urdf_model()
  KDL::Chain chain;
  /// For each segment of the chain, the URDF link at its end (pushes and payloads name links).
  std::vector<std::string> segment_links;
  /// Things worth knowing that are no errors (mimic joints ignored, branches carried as load, slips
  /// in parts of the URDF that do not count, ...), each with file and line.
  std::vector<std::string> notes;
};

/// Loads `name_or_path`: a folder with robot.yaml, or the name of a shipped robot (looked up below
/// `robots_root()`). Throws ConfigError naming file, line, key, value and what is allowed. Set-up
/// only.
LoadedRobot load_robot(const std::string& name_or_path);

/// What to tell a user who named a robot that is none.
std::string no_robot_text(const std::string& name);

/// The same arm as it really is: `plant` merged onto its robot.yaml. For the simulator, which has
/// to be different from what drives and controller believe. Throws ConfigError. Set-up only.
LoadedRobot load_plant(const std::string& name_or_path, const YamlMap& plant);

/// Loads a bare URDF; limits come from the URDF (absent or zero: none, with a note), there are no
/// drives. gravity in axes of the URDF's root link.
LoadedRobot load_urdf(const std::string& urdf_path, const std::string& base, const std::string& tip,
                      const double gravity[3]);

/// Whether a folder holds a robot: robot.yaml.
bool is_robot_folder(const std::string& folder);

/// Folder of the shipped robots: $LIMBER_ROBOTS, or limber's own.
std::string robots_root();

}  // namespace limber
