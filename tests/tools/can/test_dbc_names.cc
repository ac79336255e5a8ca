// Joints whose names are the same letters to a DBC file have nodes and messages of their own.
#include <gtest/gtest.h>

#include <set>

#include "tests/tools/can/arms.h"
#include "tools/can/dbc_messages.h"

namespace limber::test_dbc_names {
namespace {

TEST(DbcNames, StayDistinct) {
  Robot robot = testing::one_motor("damiao_mit", 1, 0x11);
  for (const char* name : {"rot y", "rot_y", "rot-y", "rot_y_2", "limber", "all"}) {
    JointConfig joint = robot.joints.front();
    joint.name = name;
    joint.drive.command_id = static_cast<std::uint32_t>(robot.joints.size()) + 1;
    joint.drive.reply_id = joint.drive.command_id + 0x10;
    robot.joints.push_back(joint);
  }
  std::set<std::string> names;
  std::set<std::string> nodes;
  const auto messages = bus_tools::dbc_messages(robot, 0);
  for (const auto& message : messages) {
    EXPECT_TRUE(names.insert(message.name).second) << message.name;
    EXPECT_FALSE(message.node.empty()) << message.name;
    if (message.id >= 0x11 && message.id <= 0x17) nodes.insert(message.node);
  }
  EXPECT_EQ(nodes, (std::set<std::string>{"elbow", "rot_y", "rot_y_2", "rot_y_3", "rot_y_2_2",
                                          "limber_2", "all_2"}));
}

}  // namespace
}  // namespace limber::test_dbc_names
