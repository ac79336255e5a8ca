// robot.yaml: read, or refused with a complaint. What was read has limits that the gate can use.
#include <filesystem>
#include <string>

#include "common/config_error.h"
#include "robots/loader/load_robot.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/input_file.h"
#include "tests/fuzz/support/require.h"
#include "tests/support/source_path.h"

using namespace limber;

namespace {

/// A folder where the URDF stands under the names that the kept inputs use.
struct Folder {
  fuzz::InputFile file{"robot.yaml"};
  Folder() {
    std::filesystem::copy_file(source_path("tests/robots/data/arm/robot.urdf"),
                               file.folder() + "/robot.urdf");
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  folder.file.write(fuzz::text_of(data, size));
  try {
    const LoadedRobot arm = load_robot(folder.file.folder());
    fuzz::require_finite({arm.robot.rate_hz}, "rate");
    for (const JointConfig& joint : arm.robot.joints) {
      fuzz::require(joint.position_min < joint.position_max, "a joint has room");
      for (const double limit : {joint.torque_limit_Nm, joint.velocity_limit})
        fuzz::require(std::isfinite(limit) && limit > 0.0, "limits are above 0");
      fuzz::require(joint.torque_rate_limit_Nm_per_s > 0.0, "rate limits are above 0");
    }
  } catch (const ConfigError& error) {
    fuzz::require(*error.what() != '\0', "a refusal has words");
  }
  return 0;
}
