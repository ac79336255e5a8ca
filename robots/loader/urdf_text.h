// Checks a URDF file as text, because the URDF library reads mass "1,5" as 0 and says nothing.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace limber {

/// A URDF whose text has passed every check that needs no choice of base and tip.
struct UrdfText {
  std::string file;
  std::string text;
  std::map<std::string, int> link_lines;
  std::map<std::string, int> joint_lines;
  std::vector<std::string> notes;
};

/// Reads and checks. Throws ConfigError with every complaint, one a line. Refused without parsing:
/// more than 8 MiB, more than 10,000 elements, DOCTYPE and entities. Set-up only.
UrdfText read_urdf_text(const std::string& path);

}  // namespace limber
