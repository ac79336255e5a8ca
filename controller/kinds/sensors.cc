#include "controller/kinds/sensors.h"

#include <algorithm>

namespace limber::controller {

unsigned sensors_of(const Robot& robot) noexcept {
  if (robot.size() == 0) return 0U;
  unsigned have = sensors::kMotorEncoder | (robot.has_tip_sensor ? sensors::kTipForceSensor : 0U);
  const auto add = [&](unsigned sensor, auto has) {
    if (std::all_of(robot.joints.begin(), robot.joints.end(), has)) have |= sensor;
  };
  const auto link = [](const JointConfig& joint) {
    return joint.rigid() || joint.link_encoder.present;
  };
  const auto torque = [](const JointConfig& joint) { return joint.torque_sensor.present; };
  const auto kind = [](TransmissionKind wanted) {
    return [wanted](const JointConfig& joint) { return joint.transmission.kind == wanted; };
  };
  add(sensors::kLinkEncoder, link);
  add(sensors::kTorqueSensor, torque);
  add(sensors::kDeflection, [&](const JointConfig& joint) { return link(joint) || torque(joint); });
  add(sensors::kElasticJoints, kind(TransmissionKind::kElastic));
  add(sensors::kTwoMotors, kind(TransmissionKind::kAntagonistic));
  if (!std::all_of(robot.joints.begin(), robot.joints.end(), kind(TransmissionKind::kRigid))) {
    have |= sensors::kSprings;
  }
  return have;
}

}  // namespace limber::controller
