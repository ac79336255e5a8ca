// Replies of an ODrive axis, as the driver reads them.
#include "tests/fuzz/support/arms.h"
#include "tests/fuzz/support/drive_replies.h"

using namespace limber;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const LoadedRobot arm = fuzz::load("desktop2r_odrive");
  const JointConfig joint = fuzz::joint_of(arm.robot, 0);
  fuzz::fuzz_drive_replies(joint, fuzz::on_fd(arm.robot, joint), {data, size});
  return 0;
}
