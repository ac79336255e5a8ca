// The list of emulated drives, and nothing else: docs/adding.md.
#include <array>

#include "robots/loader/protocols/drive_protocol.h"
#include "sim/nodes/cia402_node.h"
#include "sim/nodes/cubemars_node.h"
#include "sim/nodes/damiao_node.h"
#include "sim/nodes/moteus_node.h"
#include "sim/nodes/myactuator_node.h"
#include "sim/nodes/odrive_node.h"
#include "sim/nodes/robstride_node.h"

namespace limber::sim {
namespace {

using Node = std::unique_ptr<MotorNode>;

struct Row {
  std::string_view protocol;
  Node (*make)(const JointConfig& joint, bool fd);
};

constexpr std::array kNodes = {
    Row{"damiao_mit",
        [](const JointConfig& joint, bool fd) -> Node {
          return std::make_unique<DamiaoNode>(joint, fd);
        }},
    Row{"moteus",
        [](const JointConfig& joint, bool) -> Node { return std::make_unique<MoteusNode>(joint); }},
    Row{"cia402",
        [](const JointConfig& joint, bool fd) -> Node {
          return std::make_unique<Cia402Node>(joint, fd);
        }},
    Row{"robstride",
        [](const JointConfig& joint, bool) -> Node {
          return std::make_unique<RobstrideNode>(joint);
        }},
    Row{"myactuator",
        [](const JointConfig& joint, bool) -> Node {
          return std::make_unique<MyactuatorNode>(joint);
        }},
    Row{"cubemars",
        [](const JointConfig& joint, bool) -> Node {
          return std::make_unique<CubemarsNode>(joint);
        }},
    Row{"odrive",
        [](const JointConfig& joint, bool) -> Node { return std::make_unique<OdriveNode>(joint); }},
};

}  // namespace

std::unique_ptr<MotorNode> make_motor_node(const JointConfig& joint, bool fd) {
  return row_of(kNodes, *joint.drive.protocol).make(joint, fd);
}

}  // namespace limber::sim
