// Replies of a MyActuator drive, as the driver reads them.
#include "tests/fuzz/support/arms.h"
#include "tests/fuzz/support/drive_replies.h"

using namespace limber;

// Of V4.4, or, where the input is of odd length, of V4.2.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const LoadedRobot arm = fuzz::load("axol");
  JointConfig joint = fuzz::joint_of(arm.robot, 0);
  if (size % 2 == 1) joint.drive.range = {12.5, 45.0, 24.0, 500.0, 5.0};
  fuzz::fuzz_drive_replies(joint, fuzz::on_fd(arm.robot, joint), {data, size});
  return 0;
}
