// URDF files: read, or refused with a complaint that names the file. A chain that was read has
// masses and limits that make sense.
#include <string>

#include "common/config_error.h"
#include "robots/loader/load_robot.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/input_file.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile file("robot.urdf");
  static const double gravity[3] = {0.0, 0.0, -9.81};
  file.write(fuzz::text_of(data, size));
  try {
    const LoadedRobot arm = load_urdf(file.path(), "base", "hand", gravity);
    for (const JointConfig& joint : arm.robot.joints) {
      fuzz::require(joint.position_min < joint.position_max, "a joint has room");
      fuzz::require(joint.torque_limit_Nm > 0.0 && joint.velocity_limit > 0.0, "limits");
    }
  } catch (const ConfigError& error) {
    fuzz::require(std::string(error.what()).find("robot.urdf") != std::string::npos,
                  "a refusal names the file");
  }
  return 0;
}
