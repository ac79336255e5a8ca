#include "sim/nodes/cia402_node.h"
#include "sim/nodes/damiao_node.h"
#include "sim/nodes/moteus_node.h"

namespace limber::sim {

std::unique_ptr<MotorNode> make_motor_node(const JointConfig& joint, bool fd) {
  switch (joint.drive.protocol) {
    case DriveProtocol::kMoteus:
      return std::make_unique<MoteusNode>(joint);
    case DriveProtocol::kDamiaoMit:
      break;
    case DriveProtocol::kCia402:
      return std::make_unique<Cia402Node>(joint, fd);
  }
  return std::make_unique<DamiaoNode>(joint, fd);
}

}  // namespace limber::sim
