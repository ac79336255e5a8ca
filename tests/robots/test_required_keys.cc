// The table of required keys is complete and true: without any of them a robot is refused, with
// nothing but them it loads.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>

#include "robots/loader/load_robot.h"
#include "robots/loader/required_keys.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_required_keys {
namespace {

const std::string kRobots = source_path("robots/");

/// One of each protocol.
const char* const kNames[] = {"desktop2r",  "planar2r", "iiwa14",       "openarm_right",
                              "edulite_a3", "axol",     "desktop2r_ak", "desktop2r_odrive"};

/// The mappings that a section stands for: "motors.*.mit_range" is that of every motor.
std::vector<YAML::Node> mappings(const YAML::Node& yaml, const std::string& section) {
  if (section.empty()) return {yaml};
  const std::string first = section.substr(0, section.find('.'));
  const std::string rest =
      section.find('.') == std::string::npos ? "" : section.substr(section.find('.') + 1);
  std::vector<YAML::Node> found;
  auto add = [&](const YAML::Node& node) {
    if (!node.IsDefined()) return;
    const auto below = mappings(node, rest);
    found.insert(found.end(), below.begin(), below.end());
  };
  if (first == "*") {
    for (const auto& entry : yaml) add(entry.second);
  } else if (first.ends_with("[]")) {
    for (const auto& entry : yaml[first.substr(0, first.size() - 2)]) add(entry);
  } else {
    add(yaml[first]);
  }
  return found;
}

std::vector<std::string> words(const std::string& key) {
  const auto bar = key.find('|');
  if (bar == std::string::npos) return {key};
  return {key.substr(0, bar), key.substr(bar + 1)};
}

std::string text_of(const YAML::Node& yaml) {
  YAML::Emitter out;
  out << yaml;
  return out.c_str();
}

std::string complaint(const YAML::Node& yaml) {
  try {
    check_required_keys(YamlMap::from_text(text_of(yaml), "robot.yaml"));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(RequiredKeys, EachIsMissed) {
  for (const RequiredKey& row : required_keys()) {
    bool missed = false;
    for (const char* name : kNames) {
      YAML::Node yaml = YAML::LoadFile(kRobots + name + "/robot.yaml");
      for (YAML::Node map : mappings(yaml, row.section)) {
        for (const std::string& key : words(row.key)) map.remove(key);
      }
      const std::string expected = "'" + words(row.key).front() + "' is missing: " + row.what;
      missed = missed || complaint(yaml).find(expected) != std::string::npos;
    }
    EXPECT_TRUE(missed) << row.section << " " << row.key << " " << row.only;
  }
}

/// Removes what no row names; below a key that is named but no section, everything stays.
void strip(YAML::Node map, const std::string& section, std::set<std::string>* sections) {
  std::set<std::string> named;
  for (const RequiredKey& row : required_keys()) {
    if (section != row.section) continue;
    for (const std::string& key : words(row.key)) named.insert(key);
  }
  sections->insert(section);
  std::vector<std::string> foreign;
  for (const auto& entry : map) {
    const auto key = entry.first.as<std::string>();
    if (!named.contains(key) && key != "fd") foreign.push_back(key);
  }
  for (const std::string& key : foreign) map.remove(key);
}

TEST(RequiredKeys, NoOtherIsNeeded) {
  for (const char* name : kNames) {
    YAML::Node yaml = YAML::LoadFile(kRobots + name + "/robot.yaml");
    std::set<std::string> sections;
    for (const RequiredKey& row : required_keys()) {
      if (sections.contains(row.section)) continue;
      for (const YAML::Node& map : mappings(yaml, row.section)) strip(map, row.section, &sections);
    }
    const testing::TemporaryFolder folder;
    folder.write("robot.yaml", text_of(yaml));
    folder.write("robot.urdf", testing::read_text(kRobots + name + "/robot.urdf"));
    EXPECT_NO_THROW(load_robot(folder.path())) << text_of(yaml);
  }
}

TEST(RequiredKeys, AllThatAreMissingAreToldAtOnce) {
  YAML::Node yaml = YAML::LoadFile(kRobots + "desktop2r/robot.yaml");
  yaml.remove("rate_hz");
  yaml["gains"].remove("damping_ratio");
  yaml["joints"]["elbow"].remove("reply_id");
  const std::string found = complaint(yaml);
  EXPECT_EQ(std::count(found.begin(), found.end(), '\n'), 2) << found;
  for (const char* part : {"'rate_hz' is missing: control rate", "gains: 'damping_ratio' is",
                           "joints.elbow: 'reply_id' is missing: identifier"})
    EXPECT_NE(found.find(part), std::string::npos) << found;
}

TEST(RequiredKeys, AKeyWithoutItsUnitIsASlip) {
  std::string text = testing::read_text(kRobots + "desktop2r/robot.yaml");
  text = testing::apply(text, {"", "K_x_translation_N_per_m", "K_x_translation", ""}).text;
  const std::string found = complaint(YAML::Load(text));
  EXPECT_NE(found.find("'K_x_translation_N_per_m' is missing: stiffness of the tip; "
                       "is 'K_x_translation' a slip?"),
            std::string::npos)
      << found;
}

}  // namespace
}  // namespace limber::test_required_keys
