// Replies of a CubeMars drive, as the driver reads them.
#include "tests/fuzz/support/arms.h"
#include "tests/fuzz/support/drive_replies.h"

using namespace limber;

// Of a board V2, or, where the input is of odd length, of a V3.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const LoadedRobot arm = fuzz::load("desktop2r_ak");
  JointConfig joint = fuzz::joint_of(arm.robot, 0);
  if (size % 2 == 1) {
    joint.drive.board = 3;
    joint.drive.command_id = 0x801;
    joint.drive.reply_id = 0x2901;
  }
  fuzz::fuzz_drive_replies(joint, fuzz::on_fd(arm.robot, joint), {data, size});
  return 0;
}
