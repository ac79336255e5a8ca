// The test arm with one more section in its robot.yaml.
#pragma once

#include <string>

#include "robots/loader/load_robot.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::testing {

inline const std::string kArmData = source_path("tests/robots/data/");

/// Its robot.yaml, and a file of `data/` behind it.
inline std::string arm_yaml_with(const std::string& section) {
  return read_text(kArmData + "arm/robot.yaml") + read_text(kArmData + section);
}

/// A robot.yaml beside the test arm's URDF.
struct ArmFolder {
  explicit ArmFolder(const std::string& yaml) {
    folder.write("robot.urdf", read_text(kArmData + "arm/robot.urdf"));
    file = folder.write("robot.yaml", yaml);
  }
  TemporaryFolder folder;
  std::string file;
};

/// The slip in it is refused at its place, in these words.
inline void expect_refused(const std::string& good_yaml, const Mutation& slip) {
  const Mutated bad = apply(good_yaml, slip);
  const ArmFolder folder(bad.text);
  const std::string complaint = complaint_of([&] { load_robot(folder.folder.path()); });
  expect_complaint(complaint, folder.file, bad.line, slip.expect);
}

}  // namespace limber::testing
